#include "reports/render/own_metrics.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

#include "reports/render/report.h"
#include "reports/render/store.h"

namespace moma::reports {
namespace {

using Place = std::array<std::string, 6>;  // suite, robot, controller, point, family, mode

/// Columns that a trial of the page has without the suites' own.
std::set<std::string> taken_columns(SQLite::Database& store) {
  std::set<std::string> taken{"deadline_misses", "world_key", "store", "id", "own"};
  for (const char* table : {"v_trials", "v_summary", "world"}) {
    SQLite::Statement query(store, "SELECT name FROM pragma_table_xinfo(?)");
    query.bind(1, table);
    while (query.executeStep()) taken.insert(query.getColumn(0).getString());
  }
  return taken;
}

}  // namespace

std::vector<OwnMetric> own_metrics(SQLite::Database& store, const std::set<std::string>& taken) {
  std::vector<OwnMetric> metrics;
  SQLite::Statement query(store, "SELECT id, name, expression FROM metric ORDER BY id");
  while (query.executeStep()) {
    const std::string name = query.getColumn(1).getString();
    metrics.push_back({query.getColumn(0).getInt64(), name, taken.count(name) == 0 ? name : "metric_" + name,
                       query.getColumn(2).getString()});
  }
  return metrics;
}

std::vector<OwnMetric> own_metrics(const std::filesystem::path& store, const std::set<std::string>& taken) {
  SQLite::Database opened = open_store(store);
  try {
    return own_metrics(opened, taken);
  } catch (const SQLite::Exception& error) {
    throw ReportError(fmt::format("{}: cannot be read: {}", store.string(), error.what()));
  }
}

std::string value_sql(const OwnMetric& metric, const std::string& key) {
  return fmt::format("(SELECT value FROM metric_value WHERE metric_id = {} AND metric_value.key = {})", metric.id, key);
}

std::string sql_name(const std::string& name) {
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

OwnMetrics page_metrics(SQLite::Database& store) {
  OwnMetrics metrics;
  for (const OwnMetric& metric : own_metrics(store, taken_columns(store))) {
    metrics.described.push_back({{"key", metric.column},
                                 {"of", "trial"},
                                 {"name", metric.name},
                                 {"unit", ""},
                                 {"better", ""},
                                 {"significant", 4},
                                 {"own", true},
                                 {"text", metric.expression}});
    metrics.columns += fmt::format(",\n       {} AS {}", value_sql(metric, "t.key"), sql_name(metric.column));
  }
  return metrics;
}

void add_own_means(SQLite::Database& store, const OwnMetrics& metrics, Json& page) {
  if (metrics.described.empty()) return;
  std::map<std::string, std::string> key_of;
  for (const Json& metric : metrics.described) key_of[metric.at("name")] = metric.at("key");
  std::map<Place, Json> means;
  // The mean over all families is weighted by the trials that have the value.
  SQLite::Statement query(store,
                          "SELECT suite, robot, controller, point, family, mode, metric, mean FROM v_metric_summary "
                          "UNION ALL SELECT suite, robot, controller, point, '', mode, metric, sum(n * mean) / sum(n) "
                          "FROM v_metric_summary GROUP BY suite, robot, controller, point, mode, metric");
  while (query.executeStep()) {
    Place place;
    for (int i = 0; i < 6; ++i) place[static_cast<std::size_t>(i)] = query.getColumn(i).getString();
    const SQLite::Column mean = query.getColumn(7);
    // An object from the start: the JSON library (3.11) crashes where the memory to make one of a null runs out.
    Json& of_place = means.try_emplace(place, Json::object()).first->second;
    of_place[key_of[query.getColumn(6).getString()]] =
        mean.isNull() || !std::isfinite(mean.getDouble()) ? Json(nullptr) : Json(mean.getDouble());
  }
  for (const char* part : {"summary", "overall"}) {
    for (Json& row : page.at(part)) {
      const auto text = [&](const char* key) {
        return row.at(key).is_null() ? std::string() : row.at(key).get<std::string>();
      };
      const auto found =
          means.find({text("suite"), text("robot"), text("controller"), text("point"), text("family"), text("mode")});
      row["own"] = found == means.end() ? Json::object() : found->second;
    }
  }
}

}  // namespace moma::reports
