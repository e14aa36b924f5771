#include "eval/run/replay.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "controller/config/json_node.h"
#include "controller/config/node.h"
#include "controller/config/text_file.h"
#include "eval/run/listener.h"
#include "eval/store/columns.h"
#include "eval/store/machine.h"
#include "world/sensing/detection.h"
#include "world/sensing/disturbances_file.h"
#include "world/world_json.h"

namespace moma::run {

using store::StoreError;

const Suite& StoredSuites::suite_of(const store::StoredTrial& trial) {
  const auto found = suites_.find(trial.resolved_suite);
  if (found != suites_.end()) return found->second;
  Suite suite = suite_from_resolved(
      config::parse_json(trial.resolved_suite, fmt::format("the suite of trial {}", trial.key.substr(0, 16))),
      plugins_);
  return suites_.emplace(trial.resolved_suite, std::move(suite)).first->second;
}

const SuitePoint& StoredSuites::point_of(const store::StoredTrial& trial) {
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
  const auto json = config::parse_json(trial.world, fmt::format("world of trial {}", trial.key.substr(0, 16)));
  if (json.contains("missing")) {
    throw StoreError(StoreError::Kind::kNotFound,
                     fmt::format("trial {}: its world could not be made, so there is nothing to replay ({})",
                                 trial.key.substr(0, 16), trial.row.reason));
  }
  return world_from_json(json, fmt::format("world of trial {}", trial.key.substr(0, 16)));
}

Suite stored_suite(const fs::path& store, const std::string& name, const std::string& trials, Plugins plugins) {
  auto resolved = config::parse_json(store::Reader(store).latest_suite(name),
                                     fmt::format("{}: the resolved suite {}", store.string(), name));
  if (!trials.empty()) {
    // Read as in a suite: a number, or a map; the reader of `trials` rejects anything else.
    resolved["trials"] = config::node_to_json(config::parse_yaml(trials, "--trials " + config::shortened(trials)));
  }
  return suite_from_resolved(resolved, plugins);
}

Replay replay(const fs::path& store, const std::string& name, StoredSuites& suites, TrialDetail* detail) {
  Replay replay;
  replay.trial = store::Reader(store).trial(name);
  replay.point = &suites.point_of(replay.trial);
  replay.world = world_of(replay.trial);
  replay.output =
      detail == nullptr ? run_trial(*replay.point, replay.world) : run_trial(*replay.point, replay.world, *detail);
  return replay;
}

ReplayDifferences differences(const TrialRow& stored, const std::string& machine_class, const TrialRow& replayed) {
  ReplayDifferences found{store::differences(stored, replayed), "", store::this_machine().machine_class};
  if (!machine_class.empty() && machine_class != found.this_machine) found.stored_machine = machine_class;
  return found;
}

ControlCase stored_case(StoredSuites& suites, const fs::path& file, const std::string& trial, long step) {
  const store::StoredTrial stored = store::Reader(file).trial(trial);
  try {
    return case_of_step(suites.point_of(stored), world_of(stored), step);
  } catch (const std::invalid_argument& e) {
    throw RunError(e.what());
  }
}

std::optional<double> known_before_contact(const CollisionCase& collision) {
  const World world = world_from_json(config::parse_json(collision.world, "world"), "world");
  const Disturbances disturbances =
      read_disturbances(config::parse_yaml(collision.disturbances, "disturbances"), "disturbances");
  const auto hit =
      std::ranges::find_if(world.objects, [&](const WorldObject& object) { return object.name == collision.object; });
  const DetectionRule& rule = disturbances.detection;
  if (rule.occlusion || rule.mount == SensorMount::kHand || rule.seen_by != SeenBy::kRule)
    return {};  // samples without a base do not contain the arm's motion
  if (std::ranges::any_of(world.objects, gives_way)) return {};  // nor do they contain the times of people who wait
  Detection detection(rule, world, DisturbanceStreams(world, disturbances.seed), collision.control_period);
  if (hit == world.objects.end() || !detection.on()) return {};
  const auto place = static_cast<std::size_t>(hit - world.objects.begin());
  std::vector<ObjectState> states(world.objects.size());
  for (std::size_t k = 0; k < collision.t.size(); ++k) {
    const double* base = collision.base.data() + 3 * k;
    object_states(world, collision.t[k], states);
    for (ObjectState& state : states) state.visible = true;
    detection.update(static_cast<long>(k), {base[0], base[1], base[2]}, {}, states);
    if (!states[place].visible) continue;
    // An object known from the start has no detection time.
    const double since = k == 0 ? 0.0 : collision.t[k] + disturbances.objects.delay;
    return std::max(0.0, collision.contact_time - since);
  }
  return 0.0;
}

}  // namespace moma::run
