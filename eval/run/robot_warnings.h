#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "controller/config/robot_file.h"

namespace moma::run {

/// Wheels that reach out of what can collide of the base, as seen from above, by more than 5 mm: objects beside it
/// would be run over and no collision counted. Wheels count as thin as their middle planes. Empty for a base without
/// wheels.
std::vector<std::string> wheel_warnings(const RobotModel& model);

/// Links that look larger than what can collide of them and of what is rigid with them, by more than 2 cm at `ready`:
/// one sentence that names the worst. By what is outermost of each visual of the robot file's URDF. Empty where the arm
/// has no shapes at all, and where a visual mesh cannot be read. Costs the reading of all of them, some tenths of a
/// second.
std::vector<std::string> visual_warnings(const std::filesystem::path& robot_file, const RobotModel& model);

/// Joints whose drive is too weak for the arm's own weight, at `ready` or somewhere in their range: a sentence for
/// each. With physics such an arm sags or falls, whatever its controller.
std::vector<std::string> holding_warnings(const std::shared_ptr<const RobotModel>& model);

}  // namespace moma::run
