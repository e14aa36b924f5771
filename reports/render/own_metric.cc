#include "reports/render/own_metric.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "reports/render/report.h"
#include "reports/render/store.h"

namespace moma::reports {

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

}  // namespace moma::reports
