#pragma once

#include <string>

#include "controller/ahead/plan_brief.h"
#include "controller/case/case_file.h"

namespace moma {

class ControllerCore;

std::string meaning(PlanMode mode);
std::string meaning(PlanReason reason);

/// In words: what a controller that looks ahead is doing after a case's step and why, what its last choice was made
/// among, and what it would choose now, worked out whole. Empty for other controllers.
std::string describe_plan(const ControlCase& control_case, const ControllerCore& controller);

}  // namespace moma
