#include <map>
#include <memory>

#include "eval/store/records.h"
#include "eval/trial/spec_file.h"
#include "eval/trial/trial.h"
#include "world/scenario/worlds.h"
#include "world/sensing/disturbances_file.h"
#include "world/world_json.h"

namespace moma::store {
namespace {

using Json = nlohmann::ordered_json;

/// What all points of a suite share: every key but those that name or count points.
std::string setting_of(const Json& resolved) {
  Json setting = resolved;
  for (const std::string_view key : kKeysOfTheWhole) setting.erase(std::string(key));
  for (const char* key : {"controllers", "points", "more_robots"}) setting.erase(key);
  return nlohmann::json(setting).dump();  // unordered: where a key stands in a file changes nothing
}
Hash setting_hash(const std::string& setting, int version) {
  return hash_text(setting + "#" + std::to_string(version));
}

}  // namespace

SuiteRecord describe(const Suite& suite) {
  SuiteRecord record{suite.name,
                     setting_hash(setting_of(suite.resolved), kSimulationVersion),
                     suite.resolved.dump(),
                     {},
                     suite.metrics};
  std::map<const void*, std::string> robots;  // a resolved robot is long and mostly shared
  for (const SuitePoint& point : suite.points) {
    PointRecord p;
    p.controller = point.controller;
    p.label = point.label;
    p.params = point.params.is_null() ? "{}" : point.params.dump();
    p.robot_name = point.robot->model->name;
    std::string& robot = robots[point.robot.get()];
    if (robot.empty()) robot = point.robot->resolved.dump();
    p.robot_resolved = robot;
    p.controller_resolved = point.controller_resolved.dump();
    p.worlds = point.worlds.to_json().dump();
    p.mode = point.simulation.mode;
    p.control_period_s = point.simulation.control_period;
    p.physics_step_s = point.simulation.physics_step;
    p.time_limit_s = point.simulation.time_limit;
    p.success_position_m = point.success.position;
    p.success_orientation_rad = point.success.orientation;
    p.success_dwell_s = point.success.dwell;
    p.stuck_time_s = point.stuck.time;
    p.stuck_motion = point.stuck.motion;
    p.infeasible_time_s = point.infeasible.time;
    p.simulation_version = kSimulationVersion;
    Json rules = {to_json(point.simulation), to_json(point.success), to_json(point.stuck), to_json(point.infeasible)};
    if (any(point.disturbances)) rules.push_back(to_json(point.disturbances));
    p.content_hash = hash_text(p.params + '\n' + robot + '\n' + p.controller_resolved + '\n' + p.worlds + '\n' +
                               rules.dump() + '\n' + std::to_string(kSimulationVersion));
    record.points.push_back(std::move(p));
  }
  return record;
}

bool has_setting(const Json& resolved, const Hash& hash) {
  const std::string setting = setting_of(resolved);
  for (int version = 1; version <= kSimulationVersion; ++version)
    if (setting_hash(setting, version) == hash) return true;
  return false;
}

WorldRecord describe(const World& world) {
  return {world.difficulty, {}, world.index, std::to_string(world.seed), world.family, to_json(world).dump()};
}

WorldRecord describe_missing(const Worlds& worlds, std::uint64_t index) {
  const std::string family = worlds.family_of(index);
  const Json json = {{"index", index}, {"seed", worlds.seed()}, {"family", family}, {"missing", true}};
  return {{}, {}, index, std::to_string(worlds.seed()), family, json.dump()};
}

}  // namespace moma::store
