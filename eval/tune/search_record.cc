#include "eval/tune/search_record.h"

#include "eval/suite/resolve.h"

namespace moma::tune {

store::TuneSearchRecord search_record(const Tuning& tuning) {
  store::TuneSearchRecord record;
  record.suite = tuning.suites.front().name;
  record.controller = tuning.config.controller;
  record.identity = tuning.identity.dump();
  record.objective = objective_text(tuning);
  record.unit = tuning.config.cost.unit();
  record.budget_trials = tuning.config.budget;
  return record;
}

std::string held_out_json(const Tuning& tuning) {
  const TuneConfig& config = tuning.config;
  Json json = {{"first", config.held_out.first}, {"count", config.held_out.count}};
  if (config.held_out_seed) json["seed"] = *config.held_out_seed;
  return json.dump();
}

Suite searched_suite(const Tuning& tuning) {
  Suite suite = tuning.suites.front();
  suite.points = {suite.points[tuning.tuned_point.front()]};
  suite.resolved = resolved_json(suite, false);
  return suite;
}

}  // namespace moma::tune
