#pragma once

#include <algorithm>

#include "controller/model/robot_model.h"

namespace moma {

/// Returns the factor on lengths along a joint's range (of dampers, of margins of paths): 1 for revolute joints. For a
/// prismatic joint with a range below 3 m it is the range over 3, where 3 rad is the smallest range of the arm for
/// which the lengths were chosen.
inline double limit_part(const ControlledJoint& joint) noexcept {
  constexpr double kWhole = 3.0;
  if (joint.type != JointType::kPrismatic) return 1.0;
  return std::min(1.0, (joint.upper - joint.lower) / kWhole);
}

}  // namespace moma
