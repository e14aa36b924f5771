#pragma once

#include "controller/plan/free_space.h"

namespace moma {

/// Joint values at which the arm reaches out least beyond the base, seen from above, and keeps clear of the robot
/// itself and the floor: 500 draws about `ready`, the widest first. `ready` itself for a robot that is bolted down.
VectorX tucked_arm(const RobotModel& model, FreeSpace& space, const Clearances& clearances);

}  // namespace moma
