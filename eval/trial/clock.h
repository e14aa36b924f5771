#pragma once

#include <memory>
#include <span>

#include "eval/trial/metrics.h"
#include "eval/trial/profile.h"
#include "eval/trial/spec.h"
#include "eval/trial/trial.h"

namespace moma {

/// A joint this far beyond its limit ends the trial as `joint_limit` [rad or m]. The tolerance exceeds rounding and the
/// softness of a simulated stop, and is less than any robot would survive.
inline constexpr double kJointLimitTolerance = 1e-3;

/// The loop of a trial: steps `plant` in `world` under the rules of `spec` until an outcome. Any source may compute the
/// commands:
///
///     while (clock.sense()) { compute clock.answer() from clock.seen(); clock.act(seconds); }
///     row = clock.finish();
///
/// At each sample t = k control_period, in this order: errors and distances of the state; the rules collision, dwell,
/// diverged, tipped, joint_limit, infeasible, stuck, timeout; then the command for the next period. sense() skips
/// control periods that are missed (Disturbances::control) and holds the last command in them. All measurements and
/// rules use the true state; only the controller sees the state that spec.disturbances change. Exceptions of the plant
/// pass through, and `recording` keeps all earlier samples. All arguments must outlive the clock. `profile` may be
/// null.
class TickClock {
 public:
  TickClock(const TrialSpec& spec, const World& world, Plant& plant, Recording& recording,
            ProfileClock* profile = nullptr);
  ~TickClock();
  TickClock(const TickClock&) = delete;
  TickClock& operator=(const TickClock&) = delete;

  /// The objects that a controller knows at the start of the motion: the world's objects, then false ones.
  std::span<const ObjectShape> objects() const noexcept;
  /// Measures the state at the next sample. False if the trial has ended; otherwise a command is due.
  bool sense();
  /// Once after sense() was false: updates seen() to the state in which the trial ended, if that is finite.
  void look_last();
  const Observation& seen() const noexcept;
  /// The true state at the same sample, with the world's objects alone.
  void truth(Observation& out) const;
  /// The answer to fill before act(); the controller's prepare() sizes its vectors.
  StepResult& answer() noexcept;
  /// Lets the plant follow the answer for a period. `seconds`: computing time of the answer. Throws std::runtime_error
  /// if the command does not have the robot's number of finite velocities.
  void act(double seconds);
  /// After sense() was false: returns the row without its timing.
  TrialRow finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Runs `controller` by a TickClock. Exceptions of controller and plant pass through.
TrialRow run_clock(const TrialSpec& spec, const World& world, Plant& plant, StepController& controller,
                   Recording& recording, ProfileClock* profile = nullptr);

}  // namespace moma
