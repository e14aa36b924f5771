#pragma once

#include "eval/identify/motion_log.h"
#include "eval/trial/trial.h"

namespace moma::run {

/// Simulates the trial again and returns the commands and measurements of its controller as a robot would log them.
/// Stamps have the measurement times according to the trial's delays; quantities with varying delays have no stamps.
/// Objects: those at rest that are seen at every step. `parts`: as for run_trial(). Throws std::runtime_error if the
/// trial ends by an error.
identify::MotionLog log_of_trial(const TrialSpec& spec, const World& world, const TrialParts& parts = {});

}  // namespace moma::run
