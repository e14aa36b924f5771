#pragma once

#include <memory>
#include <span>

#include "eval/trial/metrics.h"
#include "eval/trial/profile.h"
#include "eval/trial/spec.h"
#include "eval/trial/trial.h"

namespace moma {

/// A joint this far beyond its limit ends the trial as `joint_limit` [rad or m]: more than rounding and the
/// softness of a simulated stop, less than anything a robot would survive.
inline constexpr double kJointLimitTolerance = 1e-3;

/// The tick clock: steps `plant` in `world` under the rules of `spec` until one outcome is reached, whoever computes
/// the commands:
///
///     while (clock.sense()) { compute clock.answer() from clock.seen(); clock.act(seconds); }
///     row = clock.finish();
///
/// At each sample t = k control_period, in this order: errors and distances at the state; collision; dwell; diverged,
/// tipped, joint_limit, infeasible, stuck, timeout; then the command for the next period.
/// A control period that is missed (Disturbances::control) is no answer's: sense() goes on through it with the last
/// one. Everything that is measured or decides is the truth; only the controller sees what spec.disturbances make of
/// it. Exceptions of the plant pass through; what was recorded until then is in `recording`. All arguments outlive it.
/// `profile`, where there is one, is told of the parts.
class TickClock {
 public:
  TickClock(const TrialSpec& spec, const World& world, Plant& plant, Recording& recording,
            ProfileClock* profile = nullptr);
  ~TickClock();
  TickClock(const TickClock&) = delete;
  TickClock& operator=(const TickClock&) = delete;

  /// What a controller is told of when the motion begins: the world's objects, then those that are not there.
  std::span<const ObjectShape> objects() const noexcept;
  /// Measures the state at the next sample. False where the trial has ended, else a command is due.
  bool sense();
  /// After sense() was false, once: seen() of the state in which the trial ended, where that is finite.
  void look_last();
  const Observation& seen() const noexcept;
  /// The truth at the same sample; of the world's objects alone.
  void truth(Observation& out) const;
  /// To be filled before act(); the vectors of it are sized by the controller's prepare().
  StepResult& answer() noexcept;
  /// The plant follows the answer for a period. `seconds`: what computing it took. Throws std::runtime_error where the
  /// command is not the robot's number of finite velocities.
  void act(double seconds);
  /// After sense() was false: the row, but for its timing.
  TrialRow finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Runs `controller` by a TickClock. Its exceptions and those of the plant pass through.
TrialRow run_clock(const TrialSpec& spec, const World& world, Plant& plant, StepController& controller,
                   Recording& recording, ProfileClock* profile = nullptr);

}  // namespace moma
