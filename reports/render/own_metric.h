#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

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

/// Those of a store, in the order in which they came.
std::vector<OwnMetric> own_metrics(SQLite::Database& store, const std::set<std::string>& taken);

/// The same of a file. Throws ReportError where it is no store of moma's or cannot be read.
std::vector<OwnMetric> own_metrics(const std::filesystem::path& store, const std::set<std::string>& taken);

/// Its value of the trial whose key is `key` (SQL), as an expression.
std::string value_sql(const OwnMetric& metric, const std::string& key);

/// A name in SQL.
std::string sql_name(const std::string& name);

}  // namespace moma::reports
