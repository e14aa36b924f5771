#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "reports/render/json.h"

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

/// Returns the time [s] between the detection of the object and the contact; 0 if the object was never detected, empty
/// if the controller was told all objects. A callback, because the rule of detection belongs to the simulation.
using TimeKnown = std::function<std::optional<double>(const HitObject&)>;

/// Adds columns to the trials of `page` that explain failures by their samples. `goal_bearing_rad`: bearing of the goal
/// from a nonholonomic base at the end of the trial (0: ahead), if the goal rests and nothing else held the robot;
/// `known_before_contact_s`: the answer of `time_known`, if given. Columns without values are omitted. Reads at most
/// `kMostEvidence` trials of worlds below `worlds`, about 1 ms each.
void add_evidence(SQLite::Database& store, std::int64_t worlds, const TimeKnown& time_known, Json& page);

inline constexpr int kMostEvidence = 3000;

}  // namespace moma::reports
