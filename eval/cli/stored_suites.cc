#include "eval/cli/stored_suites.h"

#include <fmt/format.h>

#include "eval/trial/trial.h"
#include "world/scenario/worlds.h"

namespace moma::cli {

using store::StoreError;

const Suite& StoredSuites::suite_of(const store::StoredTrial& trial) {
  const auto found = suites_.find(trial.resolved_suite);
  if (found != suites_.end()) return found->second;
  Suite suite = suite_from_resolved(nlohmann::ordered_json::parse(trial.resolved_suite));
  return suites_.emplace(trial.resolved_suite, std::move(suite)).first->second;
}

const Point& StoredSuites::point_of(const store::StoredTrial& trial) {
  if (trial.simulation_version != kSimulationVersion) {
    throw StoreError(StoreError::Kind::kNotFound,
                     fmt::format("trial {} was simulated by version {} of the simulation, this program has version {}: "
                                 "it would not give the same result",
                                 trial.key.substr(0, 16), trial.simulation_version, kSimulationVersion));
  }
  const Suite& suite = suite_of(trial);
  if (trial.position >= suite.points.size()) {
    throw StoreError(StoreError::Kind::kUnusable,
                     fmt::format("trial {}: its suite has no point {}; the store is damaged", trial.key.substr(0, 16),
                                 trial.position));
  }
  return suite.points[trial.position];
}

World world_of(const store::StoredTrial& trial) {
  const auto json = nlohmann::ordered_json::parse(trial.world);
  if (json.contains("missing")) {
    throw StoreError(StoreError::Kind::kNotFound,
                     fmt::format("trial {}: its world could not be made, so there is nothing to replay ({})",
                                 trial.key.substr(0, 16), trial.row.reason));
  }
  return world_from_json(json, fmt::format("world of trial {}", trial.key.substr(0, 16)));
}

}  // namespace moma::cli
