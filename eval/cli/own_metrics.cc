#include "eval/cli/own_metrics.h"

#include <fmt/format.h>

#include "eval/store/query.h"

namespace moma::cli {

std::vector<OwnMetric> own_metrics(const std::filesystem::path& file, const std::set<std::string>& taken) {
  std::vector<OwnMetric> metrics;
  for (const auto& row : store::query(file, "SELECT id, name FROM metric ORDER BY id").rows) {
    const std::string name = std::get<std::string>(row[1]);
    metrics.push_back({std::get<std::int64_t>(row[0]), name, taken.count(name) == 0 ? name : "metric_" + name});
  }
  return metrics;
}

std::string value_sql(const OwnMetric& metric, const std::string& key) {
  return fmt::format("(SELECT value FROM metric_value WHERE metric_id = {} AND metric_value.key = {})", metric.id, key);
}

std::string sql_name(const std::string& name) {
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace moma::cli
