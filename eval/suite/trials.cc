#include "eval/suite/trials.h"

#include <fmt/format.h>

#include "controller/config/read_described.h"
#include "controller/config/write_described.h"
#include "eval/trial/outcome.h"

namespace moma {
namespace {

using config::MapReader;
using config::Node;

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
  suite.trials = static_cast<std::uint64_t>(config::read_integer(node, key, 1, static_cast<long long>(kMaxTrials)));
}

nlohmann::ordered_json trials_json(const Suite& suite) {
  if (!suite.until) return suite.trials;
  return {{"until", config::write_described(*suite.until)}};
}

}  // namespace moma
