#include "controller/config/read_described.h"

#include <cctype>

namespace moma::config::description {

bool is_word(const Node& node, std::string_view word) {
  return node.kind == Node::Kind::kScalar && node.scalar == word;
}

std::vector<double> read_list(const Node& node, const std::string& key, int count, const About& about) {
  if (!about.one_for_all || node.kind == Node::Kind::kSequence) return read_numbers(node, key, count, about.range);
  const double value = read_number(node, key, about.range);
  return std::vector<double>(count >= 0 ? static_cast<std::size_t>(count) : 1, value);
}

void refuse_other_words(const Node& node, const std::string& key, std::string_view word, const std::string& accepted) {
  if (node.kind != Node::Kind::kScalar || node.scalar.empty()) return;
  if (std::isalpha(static_cast<unsigned char>(node.scalar[0])) == 0) return;
  refuse(node.mark, key, "found '" + node.scalar + "', expected " + std::string(word) + " or " + accepted);
}

const Node& sequence(const Node& node, const std::string& key) {
  if (node.kind != Node::Kind::kSequence) refuse(node.mark, key, "found " + found_text(node) + ", expected a list");
  return node;
}

}  // namespace moma::config::description
