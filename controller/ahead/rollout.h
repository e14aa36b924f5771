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
};

constexpr auto words(Of<RolloutEnd>) {
  return std::to_array<std::string_view>({"goes_on", "arrives", "touches", "stagnates"});
}

/// When a rollout ends.
struct RolloutLimits {
  double time = 10.0;           ///< [s]
  double touch = 0.005;         ///< distance to an object at which it fails [m]
  double position = 0.02;       ///< of E from the goal at which it has arrived [m]
  double orientation = 0.05;    ///< [rad]
  bool stagnation_ends = true;  ///< a stagnation, further to one that is due anyway, ends it
};

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
  ControllerCore policy_;
  RolloutLimits limits_;
  int allowed_ = 0;  // stagnations
  Observation state_;
  StepResult result_;
  double time_ = 0.0;
  RolloutEnd end_ = RolloutEnd::kGoesOn;
};

}  // namespace moma
