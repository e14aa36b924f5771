#pragma once

#include <SQLiteCpp/Database.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "eval/store/records.h"

namespace moma::store {

/// Where a suite's parts are in the tables.
struct Registered {
  std::int64_t suite_id = 0;
  std::string suite_name;  ///< as shown
  std::int64_t resolved_suite_id = 0;
  std::vector<std::int64_t> point_ids;
  std::vector<std::string> controller_names;  ///< as shown, per point
};

/// Finds or adds the suite and its points. Call within a transaction. Throws SQLite::Exception.
Registered register_suite(SQLite::Database& db, const SuiteRecord& suite);

/// Id of a suite's own metric, added where it is new.
std::int64_t metric_id(SQLite::Database& db, const std::string& name, const std::string& expression);

/// "NAME", or the first of "NAME@2", "NAME@3" ... for which `taken(candidate)` is false.
template <typename Taken>
std::string free_name(const std::string& name, const Taken& taken) {
  std::string candidate = name;
  for (int i = 2; taken(candidate); ++i) candidate = name + "@" + std::to_string(i);
  return candidate;
}

}  // namespace moma::store
