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

const Suite& StoredSuites::suite_of(const store::StoredPoint& point, const std::string& of) {
  const auto found = suites_.find(point.resolved_suite);
  if (found != suites_.end()) return found->second;
  Suite suite = suite_from_resolved(config::parse_json(point.resolved_suite, "the suite of " + of), plugins_);
  return suites_.emplace(point.resolved_suite, std::move(suite)).first->second;
}

const SuitePoint& StoredSuites::point_of(const store::StoredPoint& point, const std::string& of) {
  if (point.simulation_version != kSimulationVersion) {
    throw StoreError(StoreError::Kind::kNotFound,
                     fmt::format("{} was simulated by version {} of the simulation, this program has version {}: it "
                                 "would not give the same result",
                                 of, point.simulation_version, kSimulationVersion));
  }
  const Suite& suite = suite_of(point, of);
  if (point.position >= suite.points.size()) {
    throw StoreError(StoreError::Kind::kUnusable,
                     fmt::format("{}: its suite has no point {}; the store is damaged", of, point.position));
  }
  return suite.points[point.position];
}

World world_of(const store::StoredTrial& trial) {
  const std::string name = "world of " + trial_name(trial);
  const auto json = config::parse_json(trial.world, name);
  if (json.contains("missing")) {
    throw StoreError(StoreError::Kind::kNotFound,
                     fmt::format("{}: its world could not be made, so there is nothing to replay ({})",
                                 trial_name(trial), trial.row.reason));
  }
  return world_from_json(json, name);
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
