#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace moma::cli {

/// A metric that a suite of the store defines itself.
struct OwnMetric {
  std::int64_t id = 0;
  std::string name;    ///< as shown
  std::string column;  ///< the name, "metric_NAME" where `taken` has that already
};

/// Those of a store, in the order in which they came. Throws StoreError.
std::vector<OwnMetric> own_metrics(const std::filesystem::path& file, const std::set<std::string>& taken);

/// Its value of the trial with key `key` (SQL), as an expression.
std::string value_sql(const OwnMetric& metric, const std::string& key);

/// A name in SQL.
std::string sql_name(const std::string& name);

}  // namespace moma::cli
