#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>

#include "controller/lookahead/choice.h"
#include "controller/lookahead/path_watch.h"
#include "controller/lookahead/plan_state.h"
#include "controller/lookahead/rollout.h"
#include "controller/plan/follow.h"
#include "controller/qp/limits.h"

namespace moma {

/// The look-ahead chooses the quicker of two: the controller's own policy, which it predicts (rollout.h), and a path of
/// base and arm, which it plans (planner.h). The gains `plan.decisions` time all that follows.
///
/// A step calls decide(), which depends on PlanState and the observation alone. Once the command is known, it calls
/// work(), which spends at most `budget` checks, or its share of `rate`, on predictions and plans and leaves their
/// results in the state for the next step. During a choice the policy goes on for a moment if its prediction is safe,
/// and the choice takes effect at the end of that moment. Otherwise the robot stops and chooses at rest.
///
/// At the start and after a jump of the goal, a robot at rest searches a direct way (direct_way.h) and follows it. If
/// none is free, it predicts the policy, and chooses at rest if that fails. The look-ahead predicts a policy that
/// drives every `period` seconds. It begins a choice at the start, and if the policy stagnates or its prediction fails;
/// else it looks for a direct way alone. A robot on a path searches one from where it will be in a moment, or a quicker
/// path: every `period` seconds on a planned path, at once if its goal jumps or as it sets out on a path from rest. If
/// it finds none, the policy takes over once its prediction is quicker than the rest of the path. If the path is
/// blocked or the robot makes no progress, the look-ahead chooses again. The policy pursues a goal in motion as long as
/// its prediction arrives or keeps pursuing. Otherwise the robot follows a path to the goal's expected place until the
/// policy's prediction arrives.
///
/// One per controller. Only construction and reset() allocate.
class Lookahead {
 public:
  Lookahead(std::shared_ptr<const RobotModel> model, const ControllerParams& params, double control_period);

  void reset(std::span<const ObjectShape> objects);

  /// Begins a step. `o`: the observation on which the controller acts; `error`: [e_R; e_p] of E; `R_WG`: axes of the
  /// goal, if it has free directions; `drive`: share of the base's accelerations for which ways and paths are planned;
  /// `missed`: control periods missed since the last step, in which the robot went on.
  void decide(const Observation& o, const Vector6& error, const Matrix3& R_WG, double drive, int missed) noexcept;
  /// True if velocities() replace the policy's task in this step. They are those of a path, or zero.
  bool guides() const noexcept { return guides_; }
  const VectorX& velocities() const noexcept { return wanted_; }
  /// Returns the distance to objects at rest that rows keep while the robot follows a path close to objects at its
  /// goal.
  KeptDistance keeps() const noexcept;
  /// True if the robot is so near to its path that it passes what the path passes: no farther than the part of the
  /// path's clearance that rows do not keep. A path to a goal close to an object has no such room: always true there.
  bool passes() const noexcept;
  /// True if this step clears the policy's memory of detours first.
  bool begins_anew() const noexcept { return anew_; }
  /// Bounds of the joints on a path. They begin nearer to the limits, because the path itself keeps away from them.
  const VelocityBounds& bounds() const noexcept { return bounds_; }
  /// Ends a step: works on predictions and plans within the budget. `o` as in decide(). `escape`: the policy's memory
  /// of detours before it acted in this step.
  void work(const Observation& o, const EscapeState& escape) noexcept;

  const PlanState& state() const noexcept { return state_; }
  /// Continues from such a state, after reset(). Work in progress begins again.
  void set_state(const PlanState& state) noexcept;

  /// Number of checks in the last step.
  long checks() const noexcept { return checks_; }
  const Planner& planner() const noexcept { return choice_.planner(); }

 private:
  enum class Job { kNone, kSetOut, kPredict, kChoose, kGoOn, kPass };
  enum class Detours { kKept, kCleared };  // the policy's memory of them

  /// Changes `doing`, and mode and reason of the brief with it.
  template <class Now>
  void begin(const Now& now, PlanReason reason) noexcept;
  /// Returns null if the robot does something else.
  template <class Now>
  Now* doing() noexcept {
    return std::get_if<Now>(&state_.doing);
  }
  void go_direct(PlanReason reason, Detours detours) noexcept;
  void go_on(PlanReason reason, double direct_time) noexcept;
  void look_for_way(double direct_time) noexcept;
  bool goes_on_safely() const noexcept;
  void stop(PlanReason reason, double direct_time) noexcept;
  void begin_path(PlanReason reason) noexcept;
  void place_end() noexcept;
  bool begins_at(const Observation& o) const noexcept;
  void follow(const Observation& o, Following& following) noexcept;
  /// Moves the path's clock on by `time` seconds at its rate, at most to the path's end.
  void advance_clock(double time) noexcept {
    state_.brief.clock = std::min(state_.brief.clock + state_.rate * time, state_.path.duration);
  }
  void work_set_out(const Observation& o, const EscapeState& escape, long& budget) noexcept;
  void look_ahead_on_path(const Observation& o, double ahead) noexcept;
  bool work_way(const Observation& o, double rest, const Following& following, long& budget) noexcept;
  bool work_onward(const Observation& o, long& budget) noexcept;
  bool begin_onward(const Observation& o) noexcept;
  bool append_onward(long& budget) noexcept;
  bool begin_pass(const Observation& o) noexcept;
  bool work_pass(long& budget) noexcept;
  void work_direct(const Observation& o, const EscapeState& escape, long& budget) noexcept;
  void work_path(const Observation& o, const EscapeState& escape, Following& following, long& budget) noexcept;
  void work_meeting(const Observation& o, long& budget) noexcept;
  void work_choice(const Observation& o, const EscapeState& escape, long& budget) noexcept;
  bool predict(const Observation& o, const EscapeState& escape, double time, long& budget) noexcept;
  void end_direct_prediction(bool goal_moves) noexcept;
  void choose() noexcept;
  bool stuck() noexcept;
  bool at_end() noexcept;
  std::int64_t periods(double seconds) const noexcept;
  double goes_on() const noexcept {
    return mobile_ ? params_.decisions.go_on_driving : params_.decisions.go_on_standing;
  }

  PlanParams params_;
  EscapeParams escape_;
  double dt_;
  long budget_;  // checks in a step
  bool mobile_;
  bool keeps_upright_;
  Choice choice_;
  double slope_;  // growth of a path's distance from objects with the distance from its goal
  PathWatch watch_;
  VelocityBounds bounds_;
  Rollout rollout_;

  PlanState state_;
  bool guides_ = false, anew_ = false, traffic_ = false;
  bool arrived_ = false;  // E is within a share of its goal's tolerances
  VectorX wanted_;
  PlanarShift shift_;

  Job job_ = Job::kNone;
  long debt_ = 0;  // checks of the last step beyond its budget
  long checks_ = 0;
  bool news_ = false;  // objects came into sight or left it since the last prediction began
  // The present or last prediction: its first step, and the state in which a choice takes effect.
  std::int64_t predicted_from_ = 0;
  Observation later_;
  double way_from_ = 0.0;     // the path's clock at which a choice takes effect that is made on the path
  double later_time_ = -1.0;  // time of that state after the first step; negative: not reached yet [s]
};

}  // namespace moma
