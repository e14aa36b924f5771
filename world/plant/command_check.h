#pragma once

#include "controller/model/robot_model.h"

namespace moma {

/// Throws std::invalid_argument naming the coordinate where the command has a wrong size or is not finite: such a
/// number must never reach the physics.
void check_command(const RobotModel& model, const VectorX& command, double duration);

}  // namespace moma
