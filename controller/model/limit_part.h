#pragma once

#include <algorithm>

#include "controller/model/robot_model.h"

namespace moma {

/// Of lengths along a joint's range (of dampers, of margins of paths) the part that counts: those of prismatic joints
/// are shorter in proportion to a range below 3 m, the smallest, in rad, of the arm that they were found on.
inline double limit_part(const ControlledJoint& joint) noexcept {
  constexpr double kWhole = 3.0;
  if (joint.type != JointType::kPrismatic) return 1.0;
  return std::min(1.0, (joint.upper - joint.lower) / kWhole);
}

}  // namespace moma
