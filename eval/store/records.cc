#include "eval/store/records.h"

#include <fmt/format.h>

#include <map>

#include "eval/store/table.h"
#include "eval/trial/spec_file.h"
#include "eval/trial/trial.h"
#include "world/scenario/worlds.h"
#include "world/world_json.h"

namespace moma::store {
namespace {

/// Setting that all points of a suite share: every key but those that name or count points.
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
    p.stuck_time_s = point.stuck.ends.time;
    p.stuck_motion = point.stuck.ends.motion;
    p.infeasible_time_s = point.infeasible.time;
    p.simulation_version = kSimulationVersion;
    Json rules = Json::array();
    const Json sections = sections_json(point);
    for (const auto& section : sections) rules.push_back(section);
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

namespace {

/// Id of the row of a content table with this text, added where it is new.
template <class R>
std::int64_t content_id(SQLite::Database& db, const char* table, R content) {
  content.hash = hash_text(content.resolved);
  const auto id = row<std::int64_t>(db, fmt::format("SELECT id FROM {} WHERE hash = ?", table), content.hash);
  return id ? *id : Table<R>(db, table, {"id"}).insert(content);
}

/// A name like this one that no row has; `rows` is the rest of the query for one, its first parameter the name.
template <class... Args>
std::string unused_name(SQLite::Database& db, const std::string& like, const char* rows, const Args&... args) {
  return free_name(like, [&](const std::string& name) {
    return row<int>(db, fmt::format("SELECT 1 FROM {}", rows), name, args...).has_value();
  });
}

void add_suite(SQLite::Database& db, const SuiteRecord& suite, Registered& out) {
  const auto found = row<std::int64_t, std::string>(
      db, "SELECT id, name FROM suite WHERE file_name = ? AND setting_hash = ?", suite.name, suite.setting_hash);
  if (found) {
    std::tie(out.suite_id, out.suite_name) = *found;
    return;
  }
  out.suite_name = unused_name(db, suite.name, "suite WHERE name = ?");
  out.suite_id = Table<SuiteRow>(db, "suite", {"id"}).insert({out.suite_name, suite.name, suite.setting_hash});
}

void add_point(SQLite::Database& db, const PointRecord& point, int position, Registered& out) {
  auto found = row<std::int64_t, std::string>(
      db,
      "SELECT id, controller FROM point WHERE suite_id = ? AND controller_name = ? AND label = ? AND content_hash = ?",
      out.suite_id, point.controller, point.label, point.content_hash);
  if (!found) {
    PointRow added = point;
    added.controller_name = point.controller;
    added.controller = unused_name(db, point.controller, "point WHERE controller = ? AND suite_id = ? AND label = ?",
                                   out.suite_id, point.label);
    added.suite_id = out.suite_id;
    added.robot_id = content_id<RobotRow>(db, "robot", {{}, point.robot_name, point.robot_resolved});
    added.controller_id = content_id<ContentRow>(db, "controller", {{}, point.controller_resolved});
    added.resolved_suite_id = out.resolved_suite_id;
    added.resolved_position = position;
    found.emplace(Table<PointRow>(db, "point", {"id"}).insert(added), added.controller);
  }
  out.point_ids.push_back(std::get<0>(*found));
  out.controller_names.push_back(std::get<1>(*found));
}

}  // namespace

std::int64_t metric_id(SQLite::Database& db, const std::string& name, const std::string& expression) {
  if (const auto id =
          row<std::int64_t>(db, "SELECT id FROM main.metric WHERE file_name = ? AND expression = ?", name, expression))
    return *id;
  return Table<MetricRow>(db, "main.metric", {"id"})
      .insert({unused_name(db, name, "main.metric WHERE name = ?"), name, expression});
}

Registered register_suite(SQLite::Database& db, const SuiteRecord& suite) {
  Registered out;
  out.resolved_suite_id = content_id<ContentRow>(db, "resolved_suite", {{}, suite.resolved});
  add_suite(db, suite, out);
  for (std::size_t i = 0; i < suite.points.size(); ++i) {
    add_point(db, suite.points[i], static_cast<int>(i), out);
  }
  return out;
}

}  // namespace moma::store
