#include "eval/suite/sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "controller/config/read_described.h"

namespace moma {

using config::Node;

SamplesKept read_samples(const Node& node, const std::string& key) {
  SamplesKept samples{};
  config::description::read_any(node, key, samples, {}, {});
  return samples;
}

void read_metrics(const Node& node, const std::string& key, Suite& suite) {
  if (node.kind != Node::Kind::kMap)
    config::fail(node.mark, key, "expected a map {NAME: SQL expression over a trial's samples}");
  for (const auto& [name, expression] : node.entries) {
    const std::string full = key + "." + name;
    const auto word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
    if (name.empty() || name.size() > 64 || !std::all_of(name.begin(), name.end(), word))
      config::fail(node.mark, full, "a metric's name has 1 to 64 letters, digits and underscores");
    suite.metrics.emplace_back(name, config::read_string(expression, full));
    suite.metric_marks.push_back(expression.mark);
  }
}

std::string read_notes(const Node& node, const std::string& key) {
  if (node.kind == Node::Kind::kScalar) return node.scalar;
  const char* found = node.kind == Node::Kind::kMap ? "a map" : "a list";
  config::fail(
      node.mark, key,
      fmt::format("found {}, expected text in Markdown; after `{}: |` it has any number of lines", found, key));
}

}  // namespace moma
