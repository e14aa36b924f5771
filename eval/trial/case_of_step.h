#pragma once

#include "controller/case/case_file.h"
#include "eval/trial/trial.h"

namespace moma {

/// The control step k = 0, 1, 2 ... of a trial as a case: the trial is simulated again up to there, and what its
/// controller saw and remembered is written down, so that `moma solve` repeats the step to the last bit.
/// Throws std::invalid_argument where the trial ends before, or where its controller is a plugin.
ControlCase case_of_step(const TrialSpec& spec, const World& world, long k);

}  // namespace moma
