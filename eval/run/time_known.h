#pragma once

#include <optional>
#include <string>
#include <vector>

namespace moma::run {

/// A collision of a stored trial, with the robot's motion before it.
struct CollisionCase {
  std::string world;            ///< JSON, as stored
  std::string disturbances;     ///< JSON, as stored
  std::string object;           ///< name of the touched object
  double control_period = 0.0;  ///< [s]
  double contact_time = 0.0;    ///< [s]
  std::vector<double> t;        ///< times of the samples [s]
  std::vector<double> base;     ///< x, y, heading of each sample, one after the other [m, m, rad]
};

/// Returns the time [s] between the detection of the object, by the simulation's own rule (world/sensing/detection.h),
/// and the collision. Empty if the object is not one of the world's, or if no detection was needed. Throws if worlds or
/// disturbances cannot be read.
std::optional<double> known_before_contact(const CollisionCase& collision);

}  // namespace moma::run
