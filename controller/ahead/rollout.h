#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>

#include "controller/controller_core.h"
#include "controller/describe/enumeration.h"

namespace moma {

/// How a rollout ended.
enum class RolloutEnd {
  kGoesOn,     ///< not yet, or only its time is up
  kArrives,    ///< E is at the goal
  kTouches,    ///< an object comes too near
  kStagnates,  ///< no progress: one stagnation more than allowed
  kLate,       ///< E cannot be at the goal within its time any more
};

constexpr auto words(Of<RolloutEnd>) {
  return std::to_array<std::string_view>({"goes_on", "arrives", "touches", "stagnates", "late"});
}

/// When a rollout ends.
struct RolloutLimits {
  double time = 10.0;           ///< [s]
  double touch = 0.005;         ///< distance to an object at which it fails [m]
  double position = 0.02;       ///< of E from the goal at which it has arrived [m]
  double orientation = 0.05;    ///< [rad]
  bool stagnation_ends = true;  ///< a stagnation, further to one that is due anyway, ends it
  bool late_ends = false;       ///< so does what the servo's speed leaves no time for
};

/// Limits of a prediction of at most `time` seconds: it arrives well inside the tolerances of the detours.
RolloutLimits prediction_limits(const PlanParams& plan, const EscapeParams& escape, double time) noexcept;

/// The time that the servo needs to bring E from an error [e_R; e_p] into the limits' tolerances where nothing holds it
/// back [s]: at the speed to which its twist is clamped, and where that is less as k e decays.
double least_time(const ServoParams& servo, const Vector6& error, const RolloutLimits& limits) noexcept;

/// Takes over all of an observation among no more objects. Takes no memory where the sizes are those of before.
void copy_observation(const Observation& from, Observation& to) noexcept;

/// A controller's own policy, rolled out in a model of the world: what the robot will do, and why it will stop. In the
/// model drives ramp the base as the robot's do and velocities are otherwise what is commanded, integrated exactly;
/// objects and goal go on with the twists they have.
///
/// Lateness and filters of a predicting controller enter by where it begins: the state that the predictor gives is that
/// at which the next command acts, and from there on the model is not late. The rollout's own controller therefore
/// predicts nothing. Its period may be longer than the robot's.
///
/// Built once; reset() may take memory, nothing else does. The same inputs give the same bits.
class Rollout {
 public:
  /// `params` as a Controller takes them, with or without looking ahead. `period` [s] > 0 of the rollout's steps.
  /// Throws as Controller does.
  Rollout(std::shared_ptr<const RobotModel> model, ControllerParams params, double period);

  void reset(std::span<const ObjectShape> objects);
  /// Begins at `o`, the state at which the next command acts, with what a controller remembers of detours. As many
  /// objects as reset() was given.
  void begin(const Observation& o, const EscapeState& escape, const RolloutLimits& limits) noexcept;
  /// One step of it. kGoesOn until it ends.
  RolloutEnd step() noexcept;
  /// Steps until it ends, its time is up or `budget` checks are used up, kChecks a step. True as long as there is more
  /// to do.
  bool advance(long& budget) noexcept;
  /// What a step takes, in checks of a configuration's distances: measured.
  static constexpr long kChecks = 6;

  RolloutEnd end() const noexcept { return end_; }
  /// True where its time is up.
  bool over() const noexcept { return time_ + 0.5 * period_ > limits_.time; }
  /// Since its beginning [s].
  double time() const noexcept { return time_; }
  double period() const noexcept { return period_; }
  /// Where everything is now, and what the last step came to.
  const Observation& state() const noexcept { return state_; }
  const StepResult& result() const noexcept { return result_; }
  const ControllerCore& policy() const noexcept { return policy_; }
  ControllerCore& policy() noexcept { return policy_; }

 private:
  std::shared_ptr<const RobotModel> model_;
  double period_;
  double patience_;
  ServoParams servo_;
  ControllerCore policy_;
  RolloutLimits limits_;
  int allowed_ = 0;  // stagnations
  Observation state_;
  StepResult result_;
  double time_ = 0.0;
  RolloutEnd end_ = RolloutEnd::kGoesOn;
};

}  // namespace moma
