#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/step.h"
#include "eval/trial/clearance.h"
#include "eval/trial/metrics.h"
#include "eval/trial/profile.h"
#include "eval/trial/rules.h"
#include "eval/trial/spec.h"
#include "world/sensing/actuation.h"
#include "world/sensing/sensing.h"
#include "world/yielding.h"

namespace moma {

/// A joint this far beyond its limit ends the trial as `joint_limit` [rad or m]. The tolerance exceeds rounding and the
/// softness of a simulated stop, and is less than any robot would survive.
inline constexpr double kJointLimitTolerance = 1e-3;

/// The loop of a trial: steps `plant` in `world` under the rules of `spec` until an outcome. Any source may compute the
/// commands:
///
///     while (loop.sense()) { compute loop.answer() from loop.seen(); loop.act(seconds); }
///     row = loop.finish();
///
/// At each sample t = k control_period, in this order: errors and distances of the state; the rules collision,
/// spilled, dwell, diverged, tipped, joint_limit, infeasible, stuck, timeout; then the command for the next period.
/// sense() skips control periods that are missed (Disturbances::control) and holds the last command in them. All
/// measurements and rules use the true state; only the controller sees the state that spec.disturbances change.
/// Exceptions of the plant pass through, and `recording` keeps all earlier samples. All arguments must outlive the
/// loop. `profile` may be null.
class TrialLoop {
 public:
  TrialLoop(const TrialSpec& spec, const World& world, Plant& plant, Recording& recording,
            ProfileClock* profile = nullptr);
  TrialLoop(const TrialLoop&) = delete;
  TrialLoop& operator=(const TrialLoop&) = delete;

  /// The objects that a controller knows at the start of the motion: the world's objects, then false ones; none if it
  /// is told by depth.
  std::span<const ObjectShape> objects() const noexcept { return told_; }
  /// Measures the state at the next sample. False if the trial has ended; otherwise a command is due.
  bool sense();
  /// Once after sense() was false: updates seen() to the state in which the trial ended, if that is finite.
  void look_last();
  const Observation& seen() const noexcept { return observation_; }
  /// Hands over the sensors' frames that have arrived (StepController::see), before a step.
  void show(StepController& controller);
  /// The true state at the same sample, with the world's objects alone.
  void truth(Observation& out) const;
  /// The answer to fill before act(); the controller's prepare() sizes its vectors.
  StepResult& answer() noexcept { return result_; }
  /// Lets the plant follow the answer for a period. `seconds`: computing time of the answer. Throws std::runtime_error
  /// if the command does not have the robot's number of finite velocities.
  void act(double seconds);
  /// After sense() was false: returns the row without its timing.
  TrialRow finish();

 private:
  double time(long k) const { return static_cast<double>(k) * period_; }
  void look();
  bool misses_period() const;
  void apply_answer();
  void take_report();
  void compare_detectors();
  bool measure_state();
  bool end(Outcome outcome, std::string reason = {});
  bool ends();
  bool all_at_rest() const;
  bool is_last_goal() const { return goal_index_ == world_.further.size(); }
  void take_goal();
  void look_at_next();
  void goal_reached();
  void hold(const std::optional<Carried>& carried);
  void take_or_leave(const WorldGoal& goal);
  void move_carried();
  std::string joint_over_limit() const;
  std::string situation();
  void note_latencies();
  std::string link_of(int shape) const;
  void describe_contacts(TrialRow& row) const;

  const TrialSpec& spec_;
  const World& world_;
  std::shared_ptr<RobotModel> hand_;  // the robot with a spare shape, if it holds an object at some time
  const RobotModel& model_;
  Plant& plant_;
  Recording& r_;
  ProfileClock* profile_;
  const double period_;
  const long last_step_;
  Kinematics kinematics_;
  Proximity proximity_;
  ClearanceWatch clearance_;
  DwellRule dwell_;
  StuckTracker stuck_;
  InfeasibleTracker infeasible_;
  SeparationWatch separation_;
  Yielding yielding_;
  std::optional<Sensing> sensing_;      // only if the controller does not see the true state
  std::optional<Actuation> actuation_;  // only if the plant gets another command than the controller's
  PlantReport report_;
  Observation observation_;
  StepResult result_;
  std::vector<ObjectState> objects_;
  std::optional<Carried> carried_;
  std::vector<std::pair<int, Isometry>> left_;  // objects that were left elsewhere, with their poses
  GoalState goal_;
  std::optional<GoalState> next_;  // the goal after it
  std::size_t goal_index_ = 0;
  Vector6 error_ = Vector6::Zero();
  double tilt_ = 0.0;  // if the world asks for an upright tool [rad]
  bool objects_move_ = false;
  bool goal_moves_ = false;
  bool finite_ = true;
  std::vector<ObjectShape> told_;  // the objects that the controller knows
  long k_ = 0;                     // index of the sample
  Outcome outcome_ = Outcome::kError;
  std::string reason_;
};

/// Runs `controller` by a TrialLoop. Exceptions of controller and plant pass through.
TrialRow run_loop(const TrialSpec& spec, const World& world, Plant& plant, StepController& controller,
                  Recording& recording, ProfileClock* profile = nullptr);

}  // namespace moma
