#pragma once

#include <string>
#include <vector>

#include "controller/config/json.h"
#include "controller/model/robot_model.h"

namespace moma::config {

/// Usual range of a value, with generous bounds.
struct Usual {
  double low = 0.0;
  double high = 0.0;
  const char* unit = "";
  const char* hint = "";  ///< ": degrees?", where another unit is likely
};

/// "WHAT: 90 rad is unusual, where robots have -6.283 to 6.283 rad: degrees?", or "" where the value is usual or not
/// finite. `whose`: the things that have such values.
std::string unusual(const std::string& what, double value, const Usual& usual, const char* whose = "robots");

/// Returns a sentence, with value, usual range and unit, for each value that is allowed but looks like another unit
/// (degrees, millimetres) or like no robot (inertia of no body, a footprint in the floor, wheels too slow for the
/// base's speed). `resolved`, the robot's resolved form, has its angles as they were written.
std::vector<std::string> implausible(const RobotModel& model, const Json& resolved);

}  // namespace moma::config
