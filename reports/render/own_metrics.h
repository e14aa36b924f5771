#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <nlohmann/json.hpp>
#include <string>

namespace moma::reports {

/// Metrics that the suites of a store define themselves, as the page has them beside moma's.
struct OwnMetrics {
  nlohmann::ordered_json described =
      nlohmann::ordered_json::array();  ///< for `metrics` of the page; key, name, text ...
  std::string columns;                  ///< ", (SELECT ...) AS KEY" for each, over `t`, the table of trials
};

/// A key is the metric's name as shown, "metric_NAME" where moma has a column of that name.
OwnMetrics page_metrics(SQLite::Database& store);

/// Adds `own`, means by key, to the rows of the summary and of all families together, where the store has any.
void add_own_means(SQLite::Database& store, const OwnMetrics& metrics, nlohmann::ordered_json& page);

}  // namespace moma::reports
