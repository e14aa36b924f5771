#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "reports/render/json.h"

namespace SQLite {
class Database;
}

namespace moma::reports {

/// A metric that a suite of the store defines itself.
struct OwnMetric {
  std::int64_t id = 0;
  std::string name;        ///< as shown
  std::string column;      ///< the name, "metric_NAME" where `taken` has that already
  std::string expression;  ///< of which it is computed
};

/// Returns a store's own metrics in the order of their registration.
std::vector<OwnMetric> own_metrics(SQLite::Database& store, const std::set<std::string>& taken);

/// Returns the own metrics of the store in a file. Throws ReportError if the file is no readable store of moma's.
std::vector<OwnMetric> own_metrics(const std::filesystem::path& store, const std::set<std::string>& taken);

/// Returns the SQL expression of the metric's value in the trial with the key `key` (SQL).
std::string value_sql(const OwnMetric& metric, const std::string& key);

/// Returns a quoted SQL identifier.
std::string sql_name(const std::string& name);

/// The suites' own metrics as the page has them beside moma's.
struct OwnMetrics {
  Json described = Json::array();  ///< for `metrics` of the page; key, name, text ...
  std::string columns;             ///< ", (SELECT ...) AS KEY" for each, over `t`, the table of trials
};

/// The key of a metric is its name, or "metric_NAME" if moma has a column with that name.
OwnMetrics page_metrics(SQLite::Database& store);

/// Adds `own`, the means by key, to the summary's rows per family and over all families, if the store has any.
void add_own_means(SQLite::Database& store, const OwnMetrics& metrics, Json& page);

}  // namespace moma::reports
