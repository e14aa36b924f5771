#pragma once

#include "eval/trial/spec.h"

namespace moma {

/// Returns the controller's parameters for a trial: the controller counts a goal as reached no further away than the
/// success rule does.
ControllerParams told_params(const TrialSpec& spec);

}  // namespace moma
