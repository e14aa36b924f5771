#pragma once

#include "eval/identify/motion_log.h"
#include "eval/trial/trial.h"

namespace moma::run {

/// What a trial's controller commanded and measured, step by step, as a robot would log it: the trial is simulated
/// again. Stamps say when each row's measurements were made, as the trial's delays have it; there are none of what is
/// late by another time each step. Objects: those at rest that are seen at every step. `parts`: as of run_trial(); its
/// controller is listened to. Throws std::runtime_error where the trial ends in an error.
identify::MotionLog log_of_trial(const TrialSpec& spec, const World& world, const TrialParts& parts = {});

}  // namespace moma::run
