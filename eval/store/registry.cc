#include "eval/store/registry.h"

#include <SQLiteCpp/Statement.h>
#include <fmt/format.h>

#include "eval/store/hash.h"
#include "eval/store/row_binding.h"

namespace moma::store {
namespace {

void add_suite(SQLite::Database& db, const SuiteRecord& suite, Registered& out) {
  SQLite::Statement find(db, "SELECT id, name FROM suite WHERE file_name = ? AND setting_hash = ?");
  find.bind(1, suite.name);
  bind_hash(find, 2, suite.setting_hash);
  if (find.executeStep()) {
    out.suite_id = find.getColumn(0).getInt64();
    out.suite_name = find.getColumn(1).getString();
    return;
  }
  SQLite::Statement taken(db, "SELECT 1 FROM suite WHERE name = ?");
  out.suite_name = free_name(suite.name, [&](const std::string& name) {
    taken.reset();
    taken.bind(1, name);
    return taken.executeStep();
  });
  SQLite::Statement insert(db, "INSERT INTO suite (name, file_name, setting_hash) VALUES (?, ?, ?)");
  insert.bind(1, out.suite_name);
  insert.bind(2, suite.name);
  bind_hash(insert, 3, suite.setting_hash);
  insert.exec();
  out.suite_id = db.getLastInsertRowid();
}

std::string free_controller_name(SQLite::Database& db, std::int64_t suite_id, const PointRecord& point) {
  SQLite::Statement taken(db, "SELECT 1 FROM point WHERE suite_id = ? AND controller = ? AND label = ?");
  return free_name(point.controller, [&](const std::string& name) {
    taken.reset();
    taken.bind(1, suite_id);
    taken.bind(2, name);
    taken.bind(3, point.label);
    return taken.executeStep();
  });
}

void add_point(SQLite::Database& db, const PointRecord& point, int position, Registered& out) {
  SQLite::Statement find(db,
                         "SELECT id, controller FROM point WHERE suite_id = ? AND controller_name = ? AND label = ? "
                         "AND content_hash = ?");
  find.bind(1, out.suite_id);
  find.bind(2, point.controller);
  find.bind(3, point.label);
  bind_hash(find, 4, point.content_hash);
  if (find.executeStep()) {
    out.point_ids.push_back(find.getColumn(0).getInt64());
    out.controller_names.push_back(find.getColumn(1).getString());
    return;
  }
  const std::string shown = free_controller_name(db, out.suite_id, point);
  SQLite::Statement insert(
      db,
      "INSERT INTO point (suite_id, controller, controller_name, label, params, content_hash, robot_id, controller_id, "
      "mode, control_period_s, physics_step_s, time_limit_s, success_position_m, success_orientation_rad, "
      "success_dwell_s, stuck_time_s, stuck_motion, infeasible_time_s, worlds, simulation_version, resolved_suite_id, "
      "resolved_position) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  int i = 0;
  insert.bind(++i, out.suite_id);
  insert.bind(++i, shown);
  insert.bind(++i, point.controller);
  insert.bind(++i, point.label);
  insert.bind(++i, point.params);
  bind_hash(insert, ++i, point.content_hash);
  insert.bind(++i, content_id(db, "robot", point.robot_resolved, point.robot_name));
  insert.bind(++i, content_id(db, "controller", point.controller_resolved));
  insert.bind(++i, std::string(to_string(point.simulation.mode)));
  insert.bind(++i, point.simulation.control_period);
  insert.bind(++i, point.simulation.physics_step);
  insert.bind(++i, point.simulation.time_limit);
  insert.bind(++i, point.success.position);
  insert.bind(++i, point.success.orientation);
  insert.bind(++i, point.success.dwell);
  insert.bind(++i, point.stuck.time);
  insert.bind(++i, point.stuck.motion);
  insert.bind(++i, point.infeasible.time);
  insert.bind(++i, point.worlds);
  insert.bind(++i, point.simulation_version);
  insert.bind(++i, out.resolved_suite_id);
  insert.bind(++i, position);
  insert.exec();
  out.point_ids.push_back(db.getLastInsertRowid());
  out.controller_names.push_back(shown);
}

}  // namespace

std::int64_t content_id(SQLite::Database& db, const std::string& table, std::string_view text,
                        const std::string& name) {
  const Hash hash = hash_text(text);
  SQLite::Statement find(db, fmt::format("SELECT id FROM {} WHERE hash = ?", table));
  bind_hash(find, 1, hash);
  if (find.executeStep()) return find.getColumn(0).getInt64();
  const bool named = table == "robot";
  SQLite::Statement insert(db, fmt::format("INSERT INTO {} (hash, resolved{}) VALUES (?, ?{})", table,
                                           named ? ", name" : "", named ? ", ?" : ""));
  bind_hash(insert, 1, hash);
  insert.bind(2, std::string(text));
  if (named) insert.bind(3, name);
  insert.exec();
  return db.getLastInsertRowid();
}

std::int64_t metric_id(SQLite::Database& db, const std::string& name, const std::string& expression) {
  SQLite::Statement find(db, "SELECT id FROM main.metric WHERE file_name = ? AND expression = ?");
  find.bind(1, name);
  find.bind(2, expression);
  if (find.executeStep()) return find.getColumn(0).getInt64();
  SQLite::Statement taken(db, "SELECT 1 FROM main.metric WHERE name = ?");
  const std::string shown = free_name(name, [&](const std::string& candidate) {
    taken.reset();
    taken.bind(1, candidate);
    return taken.executeStep();
  });
  taken.reset();
  SQLite::Statement insert(db, "INSERT INTO main.metric (name, file_name, expression) VALUES (?, ?, ?)");
  insert.bind(1, shown);
  insert.bind(2, name);
  insert.bind(3, expression);
  insert.exec();
  return db.getLastInsertRowid();
}

Registered register_suite(SQLite::Database& db, const SuiteRecord& suite) {
  Registered out;
  out.resolved_suite_id = content_id(db, "resolved_suite", suite.resolved);
  add_suite(db, suite, out);
  for (std::size_t i = 0; i < suite.points.size(); ++i) {
    add_point(db, suite.points[i], static_cast<int>(i), out);
  }
  return out;
}

}  // namespace moma::store
