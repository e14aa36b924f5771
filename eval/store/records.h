#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "eval/store/hash.h"
#include "eval/store/rows.h"
#include "eval/suite/suite.h"
#include "world/world.h"

namespace moma::store {

/// A suite in the form of the tables: texts and typed columns.
/// Its `controller` is as in the suite file, and the places of its parts in a store are left out.
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
/// Whether `hash` is the setting_hash of a suite with this resolved text, under any version of the simulation.
bool has_setting(const nlohmann::ordered_json& resolved, const Hash& hash);
WorldRecord describe(const World& world);
/// For a world that could not be made: its identity, without content.
WorldRecord describe_missing(const Worlds& worlds, std::uint64_t index);

}  // namespace moma::store
