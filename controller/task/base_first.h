#pragma once

#include "controller/model/robot_model.h"
#include "controller/params.h"
#include "controller/types.h"

namespace moma {

/// The base's part of separate motion, the baseline for holistic motion: the base drives until the goal is ahead of it
/// at the distance `reach`, and stands there while the arm moves. A function of the present pose alone.
struct BaseDrive {
  bool driving = false;                  ///< not there yet
  Vector3 velocity_B = Vector3::Zero();  ///< (v_x, v_y, omega) in base axes [m/s, rad/s]; zero at rest
};

/// With d and a the distance and bearing of the goal from the base's origin, in the plane, the base drives while |d -
/// reach| > tolerance or |a| > bearing, by v = gain (d - reach) and omega = gain a, each within the base's speeds. A
/// base that moves along its heading only has v max(0, cos a): it turns first. A fixed base never drives. No
/// allocation.
BaseDrive drive_into_reach(const SeparateParams& params, const MobileBase& robot, const Vector3& base,
                           const Vector3& p_WG) noexcept;

}  // namespace moma
