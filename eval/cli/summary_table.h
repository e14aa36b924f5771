#pragma once

#include <string>

#include "eval/store/query.h"

namespace moma::cli {

/// v_summary, of one suite alone unless that is "", with the suites' own metrics as columns behind moma's.
/// `for_person`: rates with their intervals in one cell, few digits, no column that says nothing; the robot is a column
/// where there are several, errors where there are any. Throws StoreError.
store::QueryResult summary_table(const fs::path& file, const std::string& suite = "", bool for_person = false);

}  // namespace moma::cli
