#include "eval/tune/stored_search.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "eval/suite/resolve.h"

namespace moma::tune {

std::string objective_text(const Tuning& tuning) {
  std::string text =
      tuning.config.cost.standard()
          ? "default: T + 5/3 L x command change + 1/6 L x manipulability lost; L = time limit, T = time to "
            "goal, 2 L for a failure, 4 L for a collision"
          : tuning.config.written["objective"].dump();
  for (const MetricBound& bound : tuning.config.bounds) text += fmt::format("; {}", constraint_of(bound).name);
  return text;
}

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
  nlohmann::ordered_json json = {{"first", config.held_out.first}, {"count", config.held_out.count}};
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
