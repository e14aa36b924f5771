#pragma once

#include "controller/plan/free_space.h"

namespace moma {

/// Returns the joint values with the least horizontal reach of the arm beyond the base that stay clear of the robot and
/// the floor: the best of 500 draws around `ready`, the widest first. It returns `ready` for a fixed robot.
VectorX tucked_arm(const RobotModel& model, FreeSpace& space, const Clearances& clearances);

}  // namespace moma
