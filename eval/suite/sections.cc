#include "eval/suite/sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "controller/config/read_described.h"
#include "controller/config/write_described.h"
#include "eval/trial/row.h"

namespace moma {

using config::MapReader;
using config::Node;

namespace {

void read_metrics(const Node& node, const std::string& key, Suite& suite) {
  if (node.kind != Node::Kind::kMap)
    config::fail(node.mark, key, "expected a map {NAME: SQL expression over a trial's samples}");
  for (const auto& [name, expression] : node.entries) {
    const std::string full = key + "." + name;
    const auto word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
    if (name.empty() || name.size() > 64 || !std::ranges::all_of(name, word))
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

UntilRule read_until(const Node& node, const std::string& key) {
  UntilRule rule;
  MapReader in(node, key);
  config::read_members(in, rule);
  if (!from_string<Outcome>(rule.metric))
    in.fail_at("metric", fmt::format("found '{}', expected an outcome: {}", rule.metric, list_of_words<Outcome>()));
  if (rule.metric == to_string(Outcome::kError))
    in.fail_at("metric",
               "found 'error', which has no rate of its own: it counts as not succeeded; name another outcome");
  in.finish();
  return rule;
}

void read_trials(const Node& node, const std::string& key, Suite& suite) {
  suite.until.reset();
  if (node.kind == Node::Kind::kMap) {
    MapReader in(node, key);
    suite.until = read_until(in.require("until", "{metric: success, half_width: 0.02, max: 5000}"), in.key_of("until"));
    in.finish();
    suite.trials = suite.until->max;
    return;
  }
  suite.trials = static_cast<std::uint64_t>(config::read_integer(node, key, 1, static_cast<long long>(kMaxTrials)));
}

}  // namespace

void read_whole(MapReader& in, Suite& suite) {
  in.read("name", suite.name);
  in.check(!suite.name.empty(), "name", "found nothing, expected a name");
  read_trials(in.require("trials", "the number of worlds, 1 or more"), "trials", suite);
  in.read_enum("samples", suite.samples);
  if (const Node* metrics = in.get("metrics")) read_metrics(*metrics, "metrics", suite);
  if (const Node* notes = in.get("notes")) suite.notes = read_notes(*notes, "notes");
}

Json trials_json(const Suite& suite) {
  if (!suite.until) return suite.trials;
  return {{"until", config::write_described(*suite.until)}};
}

}  // namespace moma
