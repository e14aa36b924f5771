#pragma once

#include <span>

#include "controller/escape_state.h"
#include "controller/memory.h"
#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/params.h"
#include "controller/step.h"
#include "controller/task/servo.h"

namespace moma {

/// Inputs of a step's decisions besides the task.
struct EscapeInput {
  const Kinematics& kinematics;
  const GoalState& goal;
  std::span<const ProximityPair> pairs;  ///< within their influence, including floor and self pairs
};

/// Leaves a local minimum on one side: after the bug algorithms (Lumelsky & Stepanov, Algorithmica 2, 1987; Kamon,
/// Rimon & Rivlin, IJRR 17(9), 1998, TangentBug), with their measure of progress and fixed side, for a robot that knows
/// distances and no map.
///
/// V = |e_p| + scale |e_R| is the distance to the goal. The robot stagnates when V has not fallen by `progress` below
/// its minimum for `patience`, and the pose is not at the goal. The minimum recedes with a goal that moves away, so
/// that only the robot's own motion counts. A goal that jumps resets everything.
///
/// A detour then draws E to a point beside the base instead of to the goal: at `angle` to one side of the goal's
/// direction, the next time to the other side, then behind, each time further. For a fixed base the arm's root replaces
/// the base, and half the arm's length is the largest distance. During a detour orientation is nearly free and the arm
/// is drawn to `ready`. moma-controller.md has the formulas. One per controller; nothing here allocates or throws.
class Escape {
 public:
  Escape(const EscapeParams& params, const ServoParams& servo, const RobotModel& model, double control_period);

  void reset() noexcept;
  /// One step: watches progress, starts and ends detours, and changes the task during a detour.
  void update(const EscapeInput& input, Task& task) noexcept;

  const EscapeState& state() const noexcept { return state_; }
  /// Continues from a state of an earlier run, whose last goal is unknown.
  void set_state(const EscapeState& state) noexcept { set_memory({state, {}, false}); }
  EscapeMemory memory() const noexcept { return {state_, last_goal_, has_goal_}; }
  void set_memory(const EscapeMemory& memory) noexcept;

 private:
  bool goal_jumped(const GoalState& goal) const noexcept;
  void watch(const EscapeInput& input, const Task& task, double V) noexcept;
  void stagnate(const EscapeInput& input, const Task& task, double V) noexcept;
  void bend(const EscapeInput& input, Task& task) const noexcept;

  EscapeParams params_;
  ServoParams servo_;
  double dt_;
  bool mobile_;
  double max_length_;
  EscapeState state_;
  GoalState last_goal_;
  bool has_goal_ = false;
};

/// Returns V = |e_p| + scale |e_R| [m].
double remaining_way(const EscapeParams& params, const Vector6& error) noexcept;

/// Horizontal unit vector of `v`, or `otherwise` if |v_xy| is below 0.02.
Vector3 heading(const Vector3& v, const Vector3& otherwise) noexcept;

/// Side with more room: +1 (left of e_h) if (e_h x a)_z >= 0, a = sum_j n_j clip(1 - d_j/reach, 0, 1) over object
/// pairs; else -1.
int free_side(std::span<const ProximityPair> pairs, const Vector3& e_h, double reach) noexcept;

}  // namespace moma
