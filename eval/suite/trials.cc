#include "eval/suite/trials.h"

#include <fmt/format.h>

#include "controller/config/reader.h"
#include "eval/trial/outcome.h"

namespace moma {
namespace {

using config::MapReader;
using config::Node;

constexpr long long kMaxTrials = 100'000'000;

UntilRule read_until(const Node& node, const std::string& key) {
  UntilRule rule;
  MapReader in(node, key);
  in.read("metric", rule.metric);
  if (!from_string<Outcome>(rule.metric))
    in.fail_at("metric", fmt::format("found '{}', expected an outcome, whose rate is meant: {}", rule.metric,
                                     list_of_words<Outcome>()));
  in.require("half_width", "half the width of the 95 % interval to reach, for instance 0.02");
  in.read("half_width", rule.half_width, {1e-4, 0.5, false, true});
  const auto count = [&](const char* name, std::uint64_t& value) {
    if (const Node* number = in.get(name))
      value = static_cast<std::uint64_t>(config::read_integer(*number, in.key_of(name), 1, kMaxTrials));
  };
  in.require("max", "the most worlds, for instance 5000");
  count("max", rule.max);
  count("block", rule.block);
  in.finish();
  return rule;
}

}  // namespace

void read_trials(const Node& node, const std::string& key, Suite& suite) {
  suite.until.reset();
  if (node.kind == Node::Kind::kMap) {
    MapReader in(node, key);
    suite.until = read_until(in.require("until", "{metric: success, half_width: 0.02, max: 5000}"), in.key_of("until"));
    in.finish();
    suite.trials = suite.until->max;
    return;
  }
  suite.trials = static_cast<std::uint64_t>(config::read_integer(node, key, 1, kMaxTrials));
}

nlohmann::ordered_json trials_json(const Suite& suite) {
  if (!suite.until) return suite.trials;
  const UntilRule& rule = *suite.until;
  return {
      {"until", {{"metric", rule.metric}, {"half_width", rule.half_width}, {"max", rule.max}, {"block", rule.block}}}};
}

}  // namespace moma
