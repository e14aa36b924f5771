#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>

#include "controller/controller_core.h"
#include "controller/describe/enumeration.h"

namespace moma {

/// End of a rollout.
enum class RolloutEnd {
  kGoesOn,     ///< it has not ended, or its time is up
  kArrives,    ///< E is at the goal
  kTouches,    ///< an object comes too near, or the tool tilts too far
  kStagnates,  ///< no progress: one stagnation more than allowed
  kLate,       ///< E cannot be at the goal within its time any more
};

constexpr auto words(Of<RolloutEnd>) {
  return std::to_array<std::string_view>({"goes_on", "arrives", "touches", "stagnates", "late"});
}

/// Conditions that end a rollout.
struct RolloutLimits {
  double time = 10.0;           ///< [s]
  double touch = 0.005;         ///< distance to an object at which it fails [m]
  double position = 0.02;       ///< position error at which it arrives [m]
  double orientation = 0.05;    ///< [rad]
  bool stagnation_ends = true;  ///< a stagnation ends it, unless one was due at its start
  bool late_ends = false;       ///< so does an error that the servo cannot remove in the time left
};

/// Returns the limits of a prediction of at most `time` seconds.
RolloutLimits prediction_limits(const PlanParams& plan, const EscapeParams& escape, double time) noexcept;

/// Returns the time in which the servo alone reduces an error [e_R; e_p] to the tolerances [s]: first at the speed to
/// which its twist is clamped, then exponentially.
double least_time(const ServoParams& servo, const Vector6& error, const RolloutLimits& limits) noexcept;

/// A rollout simulates the controller's own policy in a model of the world: drives ramp the base as the robot's do, all
/// other velocities follow commands at once and are integrated exactly, objects and goal keep their twists.
///
/// A rollout begins at the predictor's state, in which the next command takes effect. From there on its model has no
/// latency, so its controller does not predict. Its period may be longer than the robot's.
///
/// Only construction and reset() allocate. The same inputs give the same bits.
class Rollout {
 public:
  /// `params`: as for Controller, with or without `plan`. `period` > 0: control period of the rollout [s].
  /// Throws as Controller does.
  Rollout(std::shared_ptr<const RobotModel> model, ControllerParams params, double period);

  void reset(std::span<const ObjectShape> objects);
  /// Begins at `o`, the state in which the next command takes effect, with a memory of detours. `o` has as many objects
  /// as reset() was given.
  void begin(const Observation& o, const EscapeState& escape, const RolloutLimits& limits) noexcept;
  /// Simulates one step. Returns kGoesOn until the rollout ends.
  RolloutEnd step() noexcept;
  /// Simulates until the rollout ends, its time is up, or `budget` checks are spent, kChecks per step. True if work is
  /// left.
  bool advance(long& budget) noexcept;
  /// Measured cost of a step in checks.
  static constexpr long kChecks = 6;

  RolloutEnd end() const noexcept { return end_; }
  /// True if its time is up.
  bool over() const noexcept { return time_ + 0.5 * period_ > limits_.time; }
  /// Time since its start [s].
  double time() const noexcept { return time_; }
  double period() const noexcept { return period_; }
  /// Present state.
  const Observation& state() const noexcept { return state_; }

 private:
  std::shared_ptr<const RobotModel> model_;
  double period_;
  ControllerCore policy_;
  RolloutLimits limits_;
  int allowed_ = 0;  // stagnations
  Observation state_;
  StepResult result_;
  double time_ = 0.0;
  RolloutEnd end_ = RolloutEnd::kGoesOn;
};

}  // namespace moma
