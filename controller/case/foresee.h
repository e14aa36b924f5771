#pragma once

#include <string>

#include "controller/case/case_file.h"

namespace moma {

/// What the robot of a case will do in the next `seconds` [s] > 0, and why it will stop: the controller rolled out in a
/// model of the world (ahead/rollout.h), a line for each half second and for each thing that happens.
std::string foresee(const ControlCase& control_case, double seconds);

}  // namespace moma
