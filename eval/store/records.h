#pragma once

#include <SQLiteCpp/Database.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "eval/store/hash.h"
#include "eval/store/rows.h"
#include "eval/suite/suite.h"
#include "world/world.h"

namespace moma::store {

/// A point of a suite as rows of the store, without ids; `controller` is the name in the suite file.
struct PointRecord : PointRow {
  std::string robot_name;
  std::string robot_resolved;       ///< JSON
  std::string controller_resolved;  ///< JSON
};

struct SuiteRecord {
  std::string name;
  Hash setting_hash{};   ///< of the resolved suite without controllers, points and kKeysOfTheWhole
  std::string resolved;  ///< JSON
  std::vector<PointRecord> points;
  std::vector<std::pair<std::string, std::string>> metrics;  ///< name, SQL expression
};

SuiteRecord describe(const Suite& suite);
/// Returns whether `hash` is the setting_hash of this resolved suite, for any version of the simulation.
bool has_setting(const Json& resolved, const Hash& hash);
WorldRecord describe(const World& world);
/// The record of a world that could not be made: its identity without content.
WorldRecord describe_missing(const Worlds& worlds, std::uint64_t index);

/// The ids of a suite's parts.
struct Registered {
  std::int64_t suite_id = 0;
  std::string suite_name;  ///< as shown
  std::int64_t resolved_suite_id = 0;
  std::vector<std::int64_t> point_ids;
  std::vector<std::string> controller_names;  ///< as shown, per point
};

/// Finds or adds the suite and its points, within a transaction. Throws SQLite::Exception.
Registered register_suite(SQLite::Database& db, const SuiteRecord& suite);

/// Finds or adds a suite's own metric; returns its id.
std::int64_t metric_id(SQLite::Database& db, const std::string& name, const std::string& expression);

/// "NAME", or the first of "NAME@2", "NAME@3" ... for which `taken(candidate)` is false.
template <typename Taken>
std::string free_name(const std::string& name, const Taken& taken) {
  std::string candidate = name;
  for (int i = 2; taken(candidate); ++i) candidate = name + "@" + std::to_string(i);
  return candidate;
}

}  // namespace moma::store
