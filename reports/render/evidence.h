#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace moma::reports {

/// An object that was hit while the controller did not see every object from the start.
struct HitObject {
  std::string world;          ///< JSON
  std::string disturbances;   ///< JSON, the section of the suite
  std::string object;         ///< its name in the world
  double control_period = 0;  ///< [s]
  double contact_time = 0;    ///< [s]
  std::vector<double> t;      ///< of the samples [s]
  std::vector<double> base;   ///< x, y, heading of each sample, one after the other [m, m, rad]
};

/// For how long the controller had known the object at the contact [s], 0: it did not; nothing where it knew all
/// objects. Whoever has the simulation's rules answers: this folder sees only the database.
using TimeKnown = std::function<std::optional<double>(const HitObject&)>;

/// Adds to the trials of `page` what their samples tell about their failures: columns `goal_bearing_rad`, where the
/// goal lies at the end, seen from a base that cannot drive sideways (0: ahead; goals at rest, and nothing else held
/// the robot), and `known_before_contact_s` where `time_known` is given. A column without any value is left out. Of at
/// most `kMostEvidence` trials in worlds before `worlds`; about 1 ms each.
void add_evidence(SQLite::Database& store, std::int64_t worlds, const TimeKnown& time_known,
                  nlohmann::ordered_json& page);

inline constexpr int kMostEvidence = 3000;

}  // namespace moma::reports
