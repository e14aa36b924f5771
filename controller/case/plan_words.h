#pragma once

#include <string>

#include "controller/case/case_file.h"
#include "controller/lookahead/plan_brief.h"

namespace moma {

class ControllerCore;

std::string meaning(PlanMode mode);
std::string meaning(PlanReason reason);

/// Describes a controller that looks ahead after a case's step: its mode and reason, its last choice, and the choice
/// that it would make now. Empty for other controllers.
std::string describe_plan(const ControlCase& control_case, const ControllerCore& controller);

}  // namespace moma
