#pragma once

#include <vector>

#include "controller/model/robot_model.h"

namespace moma {

/// Heights of a robot's shapes that its base alone determines.
struct FloorReach {
  std::vector<bool> lifted;  ///< per shape: some controlled joint can change its height above the floor
  std::vector<bool> stands;  ///< per shape: not lifted, and on the floor or near it
};

/// Largest height of a shape that stands on the floor, the default clearance of worlds (`floor_clearance`) [m].
inline constexpr double kStanding = 0.02;

/// A revolute or continuous joint lifts the links behind it unless its axis is upright and nothing before it can tilt
/// it; a prismatic one unless its axis is level. The first link of most arms, which turns about the vertical, is
/// therefore never lifted: no posture changes its distance from the floor. The base is level, as B is. All shapes rigid
/// with the base stand, at any height. Throws nothing of its own; allocates.
FloorReach floor_reach(const RobotModel& model);

}  // namespace moma
