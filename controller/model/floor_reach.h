#pragma once

#include <vector>

#include "controller/model/robot_model.h"

namespace moma {

/// Where the heights of a robot's shapes are settled by its base alone.
struct FloorReach {
  std::vector<bool> lifted;  ///< per shape: some controlled joint can change its height over the floor
  std::vector<bool>
      stands;  ///< per shape: not lifted, and on the floor or so near that it is part of what stands there
};

/// How low a shape has to be that stands on the floor: what worlds ask of an arm (`floor_clearance`) unless told
/// otherwise [m].
inline constexpr double kStanding = 0.02;

/// A revolute or continuous joint lifts what is behind it unless its axis is upright and nothing before it can tilt it;
/// a prismatic one unless its axis is level. So the first link of most arms, which turns about the vertical, is never
/// lifted: it keeps its height, and were it to keep off the floor, no posture could help. The base is level, as B is.
/// All of what is rigid with the base stands, whatever its height. Throws nothing of its own; allocates.
FloorReach floor_reach(const RobotModel& model);

}  // namespace moma
