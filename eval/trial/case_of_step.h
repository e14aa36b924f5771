#pragma once

#include "controller/case/case_file.h"
#include "eval/trial/trial.h"

namespace moma {

/// Writes the control step k = 0, 1, 2 ... of a trial as a case: simulates the trial up to there and stores the
/// controller's observation and memory, so that `moma solve` repeats the step to the last bit. Throws
/// std::invalid_argument if the trial ends before, or if its controller is a plugin.
ControlCase case_of_step(const TrialSpec& spec, const World& world, long k);

}  // namespace moma
