#pragma once

#include "eval/trial/metrics.h"
#include "eval/trial/profile.h"
#include "eval/trial/spec.h"
#include "eval/trial/trial.h"

namespace moma {

/// A joint this far beyond its limit ends the trial as `joint_limit` [rad or m]: more than rounding and the
/// softness of a simulated stop, less than anything a robot would survive.
inline constexpr double kJointLimitTolerance = 1e-3;

/// The tick clock: runs `controller` on `plant` in `world` under the rules of `spec` until one outcome is reached.
/// At each sample t = k control_period, in this order: errors and distances at the state; collision; dwell; diverged,
/// tipped, joint_limit, infeasible, stuck, timeout; then the command for the next period.
/// Everything that is measured or decides is the truth; only the controller sees what spec.disturbances make of it.
/// Exceptions of plant or controller pass through; what was recorded until then is in `recording`. `clock`, where there
/// is one, is told of the parts.
TrialRow run_clock(const TrialSpec& spec, const World& world, Plant& plant, StepController& controller,
                   Recording& recording, ProfileClock* clock = nullptr);

}  // namespace moma
