#include "eval/suite/keys.h"

#include "controller/config/node.h"
#include "controller/describe/complete.h"
#include "controller/params_described.h"
#include "eval/suite/suite.h"
#include "eval/suite/sweep.h"

namespace moma {

static_assert(is_complete<SimulationConfig>() && is_complete<SuccessRule>() && is_complete<StillRule>() &&
              is_complete<StuckRule>() && is_complete<InfeasibleRule>() && is_complete<UntilRule>());

namespace {

void add(std::vector<Key>& to, const std::vector<Key>& keys) { to.insert(to.end(), keys.begin(), keys.end()); }

}  // namespace

std::vector<Key> suite_keys() {
  std::vector<Key> keys{
      {"name", "", "text", "the file's", "name of the suite in stores and reports"},
      {"robot", "", "a robot file, or a map as in one", "", "the robot"},
      {"controllers", "", "a map {NAME: FILE or a map as in one}", "",
       "controllers to compare; `controller.KEY` is that key of all of them"},
      {"trials", "", "a whole number from 1 to " + std::to_string(kMaxTrials) + ", or {until: ...}", "",
       "number of worlds"},
  };
  add(keys, keys_of(UntilRule{}, "trials.until"));
  keys.push_back({"samples", "", "one of: " + list_of_words<SamplesKept>(), std::string(to_string(Suite{}.samples)),
                  "the trials whose samples are stored"});
  keys.push_back({"metrics", "", "a map {NAME: SQL}", "", "metrics of the suite's own, over a trial's samples"});
  keys.push_back({"notes", "", "text", "", "Markdown for the head of the report page"});
  add(keys, keys_of(SimulationConfig{}, "simulation"));
  add(keys, keys_of(SuccessRule{}, "success"));
  add(keys, keys_of(StuckRule{}, "stuck"));
  add(keys, keys_of(InfeasibleRule{}, "infeasible"));
  add(keys, sweep_keys());
  add(keys, worlds_keys());
  add(keys, keys_of(Disturbances{}, "disturbances"));
  add(keys, keys_of(ControllerParams{}, "controller"));
  return keys;
}

std::string meant_key(const std::string& key) {
  const std::vector<Key> keys = suite_keys();
  const std::string tail = "." + key;
  for (const Key& known : keys)
    if (known.name.ends_with(tail)) return known.name;
  std::vector<std::string> names;
  for (const Key& known : keys) names.push_back(known.name);
  return config::nearest(key, names);
}

}  // namespace moma
