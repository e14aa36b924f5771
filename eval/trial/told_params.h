#pragma once

#include "eval/trial/spec.h"

namespace moma {

/// The controller's parameters as a trial makes it: told how near to the goal counts as success, it takes itself for
/// arrived no further away than that.
ControllerParams told_params(const TrialSpec& spec);

}  // namespace moma
