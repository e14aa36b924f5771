#pragma once

#include "controller/model/robot_model.h"

namespace moma {

/// Throws std::invalid_argument naming the coordinate if the command has a wrong size or is not finite, before it
/// reaches the physics.
void check_command(const RobotModel& model, const VectorX& command, double duration);

}  // namespace moma
