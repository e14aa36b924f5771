#include "eval/store/registry.h"

#include <SQLiteCpp/Statement.h>
#include <fmt/format.h>

#include "eval/store/hash.h"
#include "eval/store/table.h"

namespace moma::store {
namespace {

void add_suite(SQLite::Database& db, const SuiteRecord& suite, Registered& out) {
  SQLite::Statement find(db, "SELECT id, name FROM suite WHERE file_name = ? AND setting_hash = ?");
  find.bind(1, suite.name);
  bind_cell(find, 2, suite.setting_hash);
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
  Table<SuiteRow>(db, "suite", {"id"}).insert({out.suite_name, suite.name, suite.setting_hash});
  out.suite_id = db.getLastInsertRowid();
}

std::string free_controller_name(SQLite::Database& db, std::int64_t suite_id, const PointRow& point) {
  SQLite::Statement taken(db, "SELECT 1 FROM point WHERE suite_id = ? AND controller = ? AND label = ?");
  return free_name(point.controller_name, [&](const std::string& name) {
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
  bind_cell(find, 4, point.content_hash);
  if (find.executeStep()) {
    out.point_ids.push_back(find.getColumn(0).getInt64());
    out.controller_names.push_back(find.getColumn(1).getString());
    return;
  }
  PointRow row = point;
  row.controller_name = point.controller;
  row.suite_id = out.suite_id;
  row.controller = free_controller_name(db, out.suite_id, row);
  row.robot_id = content_id(db, "robot", point.robot_resolved, point.robot_name);
  row.controller_id = content_id(db, "controller", point.controller_resolved);
  row.resolved_suite_id = out.resolved_suite_id;
  row.resolved_position = position;
  Table<PointRow>(db, "point", {"id"}).insert(row);
  out.point_ids.push_back(db.getLastInsertRowid());
  out.controller_names.push_back(row.controller);
}

}  // namespace

std::int64_t content_id(SQLite::Database& db, const std::string& table, std::string_view text,
                        const std::string& name) {
  const Hash hash = hash_text(text);
  SQLite::Statement find(db, fmt::format("SELECT id FROM {} WHERE hash = ?", table));
  bind_cell(find, 1, hash);
  if (find.executeStep()) return find.getColumn(0).getInt64();
  const bool named = table == "robot";
  SQLite::Statement insert(db, fmt::format("INSERT INTO {} (hash, resolved{}) VALUES (?, ?{})", table,
                                           named ? ", name" : "", named ? ", ?" : ""));
  bind_cell(insert, 1, hash);
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
