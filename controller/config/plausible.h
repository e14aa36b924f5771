#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "controller/model/robot_model.h"

namespace moma::config {

/// What of a robot is allowed but looks like another unit (degrees for radians, millimetres for metres): a sentence for
/// each, with the value, what is usual and the unit. `resolved` is the robot's resolved form, whose angles are still as
/// they were written.
std::vector<std::string> implausible(const RobotModel& model, const nlohmann::ordered_json& resolved);

}  // namespace moma::config
