#include "controller/config/reader.h"

#include <cctype>
#include <charconv>
#include <limits>
#include <utility>

#include "controller/config/text_file.h"
#include "controller/describe/accepted.h"

namespace moma::config {
namespace {

const Node kNothing;

bool parse_number(const Node& node, double& value) {
  if (node.kind != Node::Kind::kScalar) return false;
  const std::string& s = node.scalar;
  if (s == ".inf" || s == "inf" || s == "+.inf") {
    value = std::numeric_limits<double>::infinity();
    return true;
  }
  if (s == "-.inf" || s == "-inf") {
    value = -std::numeric_limits<double>::infinity();
    return true;
  }
  if (node.quoted || s.empty()) return false;
  const char* begin = s.data() + (s[0] == '+' ? 1 : 0);
  const char* end = s.data() + s.size();
  // Only digits may start a number here: from_chars would take "nan" and "infinity".
  const char* first = begin + (begin != end && *begin == '-' ? 1 : 0);
  if (first == end || (!(*first >= '0' && *first <= '9') && *first != '.')) return false;
  const auto [stop, error] = std::from_chars(begin, end, value);
  return error == std::errc() && stop == end;
}

}  // namespace

std::string found_text(const Node& node) {
  switch (node.kind) {
    case Node::Kind::kNull:
      return "nothing";
    case Node::Kind::kScalar:
      return "'" + shortened(node.scalar) + "'";
    case Node::Kind::kSequence:
      return "a list of " + std::to_string(node.items.size());
    case Node::Kind::kMap:
      return "a map";
  }
  return "?";
}

double read_number(const Node& node, const std::string& key, const Range& range) {
  double value = 0.0;
  if (!parse_number(node, value) || !range.contains(value))
    refuse(node.mark, key, "found " + found_text(node) + ", expected " + accepted_number(range));
  return value;
}

long long read_integer(const Node& node, const std::string& key, long long low, long long high) {
  long long value = 0;
  bool ok = node.kind == Node::Kind::kScalar && !node.quoted && !node.scalar.empty();
  if (ok) {
    const char* end = node.scalar.data() + node.scalar.size();
    const auto [stop, error] = std::from_chars(node.scalar.data(), end, value);
    ok = error == std::errc() && stop == end && value >= low && value <= high;
  }
  if (!ok) {
    refuse(node.mark, key, "found " + found_text(node) + ", expected " + accepted_whole_number(low, high));
  }
  return value;
}

bool read_bool(const Node& node, const std::string& key) {
  if (node.kind == Node::Kind::kScalar && !node.quoted) {
    if (node.scalar == "true") return true;
    if (node.scalar == "false") return false;
  }
  refuse(node.mark, key, "found " + found_text(node) + ", expected true or false");
}

std::string read_string(const Node& node, const std::string& key) {
  if (node.kind != Node::Kind::kScalar) refuse(node.mark, key, "found " + found_text(node) + ", expected text");
  return node.scalar;
}

std::vector<double> read_numbers(const Node& node, const std::string& key, int count, const Range& range) {
  if (node.kind != Node::Kind::kSequence || (count >= 0 && static_cast<int>(node.items.size()) != count))
    refuse(node.mark, key, "found " + found_text(node) + ", expected " + accepted_numbers(count, {}));
  std::vector<double> values;
  for_items(node, key, "a list of numbers",
            [&](const Node& item, const std::string& at) { values.push_back(read_number(item, at, range)); });
  return values;
}

void fail_choice(const Node& found, const std::string& key, const std::vector<std::string>& names) {
  std::string list = joined(names);
  if (found.kind == Node::Kind::kScalar) list += suggestion(found.scalar, names);
  refuse(found.mark, key, "found " + found_text(found) + ", expected one of: " + list);
}

void require_list(const Node& node, const std::string& key, std::string_view what) {
  if (node.kind != Node::Kind::kSequence)
    refuse(node.mark, key, "found " + found_text(node) + ", expected " + std::string(what));
}

MapReader::MapReader(const Node& node, std::string key) : node_(&node), mark_(node.mark), key_(std::move(key)) {
  if (node.kind != Node::Kind::kMap && node.kind != Node::Kind::kNull)
    config::refuse(node.mark, key_, "found " + found_text(node) + ", expected a map of keys");
}

MapReader::MapReader(MapReader& outer, std::string_view name)
    : MapReader(outer.get(name) != nullptr ? *outer.get(name) : kNothing, outer.key_of(name)) {
  if (node_ == &kNothing) mark_ = outer.mark_;
}

std::string MapReader::key_of(std::string_view name) const {
  return key_.empty() ? std::string(name) : key_ + "." + std::string(name);
}

const Node* MapReader::get(std::string_view name) {
  if (std::find(known_.begin(), known_.end(), name) == known_.end()) known_.emplace_back(name);
  const Node* node = node_->find(name);
  return node != nullptr && node->kind != Node::Kind::kNull ? node : nullptr;
}

const Node& MapReader::require(std::string_view name, std::string_view what) {
  const Node* node = get(name);
  if (node == nullptr) config::refuse(mark_, key_of(name), "missing; expected " + std::string(what));
  return *node;
}

void MapReader::read(std::string_view name, double& value, const Range& range) {
  if (const Node* node = get(name)) value = read_number(*node, key_of(name), range);
}

void MapReader::read(std::string_view name, int& value, int low, int high) {
  if (const Node* node = get(name)) value = static_cast<int>(read_integer(*node, key_of(name), low, high));
}

void MapReader::read(std::string_view name, unsigned long long& value) {
  if (const Node* node = get(name)) {
    value =
        static_cast<unsigned long long>(read_integer(*node, key_of(name), 0, std::numeric_limits<long long>::max()));
  }
}

void MapReader::read(std::string_view name, bool& value) {
  if (const Node* node = get(name)) value = read_bool(*node, key_of(name));
}

void MapReader::read(std::string_view name, std::string& value) {
  if (const Node* node = get(name)) value = read_string(*node, key_of(name));
}

void MapReader::fail(const std::string& message) const { config::fail(mark_, key_, message); }

void MapReader::fail_at(std::string_view name, const std::string& message) const {
  const Node* node = node_->find(name);
  config::fail(node != nullptr ? node->mark : mark_, key_of(name), message);
}

void MapReader::fail_key(std::string_view name, const std::string& message) const {
  const Node* node = node_->find(name);
  config::fail(node != nullptr ? node->key_place() : mark_, key_of(name), message);
}

void MapReader::check(bool ok, std::string_view name, const std::string& message) const {
  if (!ok) fail_at(name, message);
}

void MapReader::finish() const {
  for (const auto& [name, value] : node_->entries) {
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    const std::string near = suggestion(name, known_);
    std::string message = "unknown key" + near;
    if (near.empty()) message += known_.empty() ? "; no keys are accepted here" : "; accepted here: " + joined(known_);
    config::refuse(value.key_place(), key_of(name), message);
  }
}

namespace description {

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

}  // namespace description
}  // namespace moma::config
