#pragma once

#include <optional>
#include <string>
#include <vector>

namespace moma::run {

/// A collision of a stored trial, and how the robot came to it.
struct CollisionCase {
  std::string world;            ///< JSON, as stored
  std::string disturbances;     ///< JSON, as stored
  std::string object;           ///< the one that was hit
  double control_period = 0.0;  ///< [s]
  double contact_time = 0.0;    ///< [s]
  std::vector<double> t;        ///< of the samples [s]
  std::vector<double> base;     ///< x, y, heading of each sample, one after the other [m, m, rad]
};

/// For how long [s] the robot had known of the object when it hit it, by the rule that the simulation found the objects
/// by (world/sensing/detection.h); none where the object is not the world's, or nothing had to be found. Throws what
/// its parts throw on worlds and disturbances that cannot be read.
std::optional<double> known_before_contact(const CollisionCase& collision);

}  // namespace moma::run
