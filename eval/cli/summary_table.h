#pragma once

#include <filesystem>
#include <string>

#include "eval/store/query.h"

namespace moma::cli {

struct SummaryOptions {
  std::string suite;        ///< of this one alone, unless ""
  std::string sort;         ///< METRIC, METRIC:up or METRIC:down; "": by controller and point
  bool for_person = false;  ///< rates with their intervals in one cell, few digits, no column that says nothing
};

/// v_summary with the suites' own metrics as columns behind moma's. Rows of one suite, robot, family and mode stay
/// together, in which they are sorted: by a metric the best first, where neither end is better the largest, unless
/// told which; rows without it last. For a person the robot is a column where there are several, errors where there
/// are any. Throws UsageError for an unknown metric, naming those that there are; StoreError.
store::QueryResult summary_table(const std::filesystem::path& file, const SummaryOptions& options);

}  // namespace moma::cli
