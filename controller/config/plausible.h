#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "controller/model/robot_model.h"

namespace moma::config {

/// What a value is expected to be, generously.
struct Usual {
  double low = 0.0;
  double high = 0.0;
  const char* unit = "";
};

/// "WHAT: 90 rad is unusual, where robots have -6.283 to 6.283 radHINT", or "" where the value is usual or not finite.
/// `whose`: of what these are usual.
std::string unusual(const std::string& what, double value, const Usual& usual, const char* hint = "",
                    const char* whose = "robots");

/// What of a robot is allowed but looks like another unit (degrees for radians, millimetres for metres), or like no
/// robot (inertia of no body, a footprint in the floor, wheels too slow for the base's speed): a sentence for each,
/// with the value, what is usual and the unit. `resolved` is the robot's resolved form, whose angles are still as they
/// were written.
std::vector<std::string> implausible(const RobotModel& model, const nlohmann::ordered_json& resolved);

}  // namespace moma::config
