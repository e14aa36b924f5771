#include "eval/store/registry.h"

#include <fmt/format.h>

#include "eval/store/hash.h"
#include "eval/store/table.h"

namespace moma::store {
namespace {

/// Id of the row of a content table with this text, added where it is new.
template <class R>
std::int64_t content_id(SQLite::Database& db, const char* table, R content) {
  content.hash = hash_text(content.resolved);
  const auto id = row<std::int64_t>(db, fmt::format("SELECT id FROM {} WHERE hash = ?", table), content.hash);
  return id ? *id : Table<R>(db, table, {"id"}).insert(content);
}

void add_suite(SQLite::Database& db, const SuiteRecord& suite, Registered& out) {
  const auto found = row<std::int64_t, std::string>(
      db, "SELECT id, name FROM suite WHERE file_name = ? AND setting_hash = ?", suite.name, suite.setting_hash);
  if (found) {
    std::tie(out.suite_id, out.suite_name) = *found;
    return;
  }
  out.suite_name = free_name(suite.name, [&](const std::string& name) {
    return row<int>(db, "SELECT 1 FROM suite WHERE name = ?", name).has_value();
  });
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
    added.controller = free_name(point.controller, [&](const std::string& name) {
      return row<int>(db, "SELECT 1 FROM point WHERE suite_id = ? AND controller = ? AND label = ?", out.suite_id, name,
                      point.label)
          .has_value();
    });
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
  const std::string shown = free_name(name, [&](const std::string& candidate) {
    return row<int>(db, "SELECT 1 FROM main.metric WHERE name = ?", candidate).has_value();
  });
  return Table<MetricRow>(db, "main.metric", {"id"}).insert({shown, name, expression});
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
