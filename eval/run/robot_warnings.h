#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "controller/config/robot_file.h"

namespace moma::run {

/// Returns a sentence for each wheel that extends beyond the base's collision shapes, as seen from above, by more than
/// 5 mm: the wheel would run over objects beside the base without a counted collision. Wheels are reduced to their
/// middle planes. Empty for a base without wheels.
std::vector<std::string> wheel_warnings(const RobotModel& model);

/// Finds links whose visuals extend beyond the collision shapes of the link and of all links rigid with it, by more
/// than 2 cm at `ready`. Returns one sentence about the worst, from the outermost points of each visual in the robot
/// file's URDF. Empty if the arm has no shapes at all, or if a visual mesh cannot be read. Reads all meshes, which
/// takes some tenths of a second.
std::vector<std::string> visual_warnings(const std::filesystem::path& robot_file, const RobotModel& model);

/// Joints whose drive is too weak for the arm's own weight, at `ready` or somewhere in their range: a sentence for
/// each. With physics such an arm sags or falls, whatever its controller.
std::vector<std::string> holding_warnings(const std::shared_ptr<const RobotModel>& model);

}  // namespace moma::run
