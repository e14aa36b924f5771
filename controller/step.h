#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "controller/escape_state.h"
#include "controller/lookahead/plan_brief.h"
#include "controller/model/proximity.h"
#include "controller/model/sensor.h"
#include "controller/model/upright.h"
#include "controller/status.h"
#include "controller/types.h"

namespace moma {

/// The goal pose and its twist [angular; linear] at its own point, world axes (zero for a fixed goal).
struct GoalState {
  Isometry X_WG = Isometry::Identity();
  Vector6 V_WG_W = Vector6::Zero();
  bool stop = true;                ///< false: E passes through it, and another goal follows
  Vector6 free = Vector6::Zero();  ///< not 0: rotation about, or place along, this axis of G is free [rx ry rz x y z]
};

/// Beyond the noise of a twist that is told as zero.
inline bool in_motion(const GoalState& goal) noexcept { return goal.V_WG_W.norm() > kAtRest; }
/// True if the goal fixes the whole pose.
inline bool is_whole(const GoalState& goal) noexcept { return goal.free.isZero(0.0); }

/// Sensed quantities at one step, never the simulator's true state.
struct Observation {
  double time = 0.0;               ///< since the start of the motion [s]
  Vector3 base = Vector3::Zero();  ///< (x, y, phi)
  VectorX q;                       ///< num_joints()
  VectorX qdot;                    ///< measured velocity, num_velocities()
  GoalState goal;
  std::optional<GoalState> next;     ///< the goal after it, where one follows and is known
  std::optional<Upright> upright;    ///< path constraint of the whole motion
  std::optional<Carried> carried;    ///< the object in the hand, whose own state means nothing
  std::vector<ObjectState> objects;  ///< in the number and order of reset()
};

/// A frame of one of the robot's sensors (model/sensor.h): the measured range of each ray, in the order of RayView.
/// Infinite: nothing in range; 0: no measurement.
struct DepthFrame {
  int sensor = 0;     ///< index into RobotModel::sensors
  double time = 0.0;  ///< at which it was taken, by the clock of Observation::time [s]
  Gaze gaze;          ///< angles of the sensor's head at that time, as measured
  VectorX ranges;     ///< [m]
};

/// Command of a step and its origin. `status` is that of the original problem; `fallback` names the stage that replaced
/// it.
struct StepResult {
  VectorX command;                  ///< num_velocities(); always finite and within its bounds
  Vector6 slack = Vector6::Zero();  ///< delta
  Vector6 error = Vector6::Zero();  ///< [e_R; e_p] as sensed
  double error_norm = 0.0;          ///< clamped, as used in the weights
  double manipulability = 0.0;
  double least_distance = std::numeric_limits<double>::infinity();  ///< to any object, within query range
  StepStatus status = StepStatus::kSolved;
  Fallback fallback = Fallback::kNone;
  int rows = 0;         ///< constraint rows of the problem
  int active_rows = 0;  ///< rows and bounds at their limit in the solution
  int iterations = 0;
  EscapeState escape;  ///< moma's memory of detours at the start of the step
  double kept = 1.0;   ///< share of the QP's command that the check ahead kept
  /// Identified time from a command to the measurement of its velocity [s]; -1: not identified.
  double latency_base = -1.0;
  double latency_joints = -1.0;
  PlanBrief plan;              ///< state of the look-ahead at the start of the step; default without one
  double solve_seconds = 0.0;  ///< 0 without timing; never part of a comparison
};

/// Interface between a controller and the world. reset() may allocate and throw, and may be called again after that;
/// step() does neither, locks nothing, logs nothing. The same sequence of calls gives the same bits.
class StepController {
 public:
  virtual ~StepController() = default;
  /// Starts a motion among these objects (their order is that of Observation::objects). Clears all state.
  virtual void reset(std::span<const ObjectShape> objects) = 0;
  /// Takes a frame that has arrived since the last step, each once, in the order of time. Ignored by default.
  virtual void see(const DepthFrame&) noexcept {}
  /// `result.command` must have been sized by prepare() or an earlier step.
  virtual void step(const Observation& observation, StepResult& result) noexcept = 0;
  /// Sizes the vectors of `result` so that step() never allocates.
  virtual void prepare(StepResult& result) const = 0;
  /// Returns the angles that the sensor's head (model/sensor.h) is to take after the last step; straight ahead by
  /// default.
  virtual Gaze gaze(int /*sensor*/) const noexcept { return {}; }
  /// Reason why the controller cannot continue, which ends a trial. Empty otherwise.
  virtual std::string_view failure() const noexcept { return {}; }
};

}  // namespace moma
