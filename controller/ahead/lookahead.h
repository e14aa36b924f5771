#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>

#include "controller/ahead/choice.h"
#include "controller/ahead/path_watch.h"
#include "controller/ahead/plan_state.h"
#include "controller/ahead/rollout.h"
#include "controller/plan/direct_way.h"
#include "controller/plan/follow.h"
#include "controller/qp/limits.h"

namespace moma {

/// Decides between the controller's own policy and planned paths, by predicting the first (rollout.h) and laying the
/// second (planner.h). The quicker one counts.
///
/// A step is decide(), which follows from PlanState and the observation alone, and, once the command is found, work():
/// no more than `budget` checks of predictions and plans that are spread over steps. What they lead to is in the state
/// for the next step. While a choice is worked out the direct policy goes on for the first half second of its
/// prediction (an arm alone: a quarter of a second) where that is safe, and the choice begins where it ends; else, and
/// where that was too short, the robot slows down and stands.
///
/// A robot that stands looks for a direct way (direct_way.h) at the start and after a goal's jump, for a quarter of a
/// second at most, and follows it where one is free. Where there is none the direct policy is predicted every `period`
/// seconds. At the start, after a goal's jump and where it is predicted to fail or has stagnated, there is a choice. On
/// a path, the direct policy takes over where it is predicted to take no longer than the path's rest; a robot that does
/// not get on, or whose path is no longer clear, chooses again. Among objects in motion the policy's own ways count:
/// only where it stagnates and none of them is near is there a choice; a goal in motion is the policy's.
///
/// One per controller. Construction and reset() may take memory, nothing else does.
class Lookahead {
 public:
  Lookahead(std::shared_ptr<const RobotModel> model, const ControllerParams& params, double control_period);

  void reset(std::span<const ObjectShape> objects);

  /// Begins a step; `o` is what the controller acts on, `error` [e_R; e_p] that of E.
  void decide(const Observation& o, const Vector6& error) noexcept;
  /// Whether velocities() replace the policy's task in this step: those of a path, or none.
  bool guides() const noexcept { return guides_; }
  const VectorX& velocities() const noexcept { return wanted_; }
  /// Distance to objects at rest that rows let the path that is followed have, where it leads nearer to its goal's
  /// objects than to others.
  KeptDistance keeps() const noexcept;
  /// True if the policy's memory of detours is to be cleared before this step.
  bool begins_anew() const noexcept { return anew_; }
  /// Bounds of joints while a path is followed, which keeps away from limits by itself: they are felt later.
  const VelocityBounds& bounds() const noexcept { return bounds_; }
  /// Ends a step: predictions and plans, within the budget. `o` as in decide(), `escape` what the policy remembered of
  /// detours in this step before it acted.
  void work(const Observation& o, const EscapeState& escape) noexcept;

  const PlanState& state() const noexcept { return state_; }
  /// Goes on from such a state; after reset(). Work in progress begins again.
  void set_state(const PlanState& state) noexcept;

  /// Checks that the last step's work took.
  long checks() const noexcept { return checks_; }
  const Planner& planner() const noexcept { return choice_.planner(); }

 private:
  enum class Job { kNone, kSetOut, kPredict, kChoose };
  enum class Detours { kKept, kCleared };  // the policy's memory of them

  /// Changes `doing`, and mode and reason of the brief with it.
  template <class Now>
  void begin(const Now& now, PlanReason reason) noexcept;
  /// Null where the robot is doing something else.
  template <class Now>
  Now* doing() noexcept {
    return std::get_if<Now>(&state_.doing);
  }
  void decide_among_traffic() noexcept;
  void go_direct(PlanReason reason, Detours detours) noexcept;
  void go_on(PlanReason reason, double direct_time) noexcept;
  void stop(PlanReason reason, double direct_time) noexcept;
  void begin_path(PlanReason reason) noexcept;
  void place_end() noexcept;
  void follow(const Observation& o, Following& following) noexcept;
  void work_set_out(const Observation& o, long& budget) noexcept;
  void work_direct(const Observation& o, const EscapeState& escape, long& budget) noexcept;
  void work_path(const Observation& o, const EscapeState& escape, long& budget) noexcept;
  void work_choice(const Observation& o, const EscapeState& escape, long& budget) noexcept;
  bool predict(const Observation& o, const EscapeState& escape, double time, long& budget) noexcept;
  void end_direct_prediction() noexcept;
  void choose() noexcept;
  bool stuck() noexcept;
  bool at_end() noexcept;
  bool near_mover(const Observation& o) const noexcept;
  std::int64_t periods(double seconds) const noexcept;

  PlanParams params_;
  EscapeParams escape_;
  double dt_;
  bool mobile_;
  Choice choice_;
  DirectWay direct_way_;
  double slope_;  // of what paths keep near their goal
  PathWatch watch_;
  VelocityBounds bounds_;
  Rollout rollout_;

  PlanState state_;
  bool guides_ = false, anew_ = false, traffic_ = false;
  bool arrived_ = false;  // E is well inside the tolerances of its goal
  VectorX wanted_;
  PlanarShift shift_;

  Job job_ = Job::kNone;
  long debt_ = 0;  // checks of the last step beyond its budget
  long checks_ = 0;
  bool news_ = false;  // objects came into sight or left it since the last prediction began
  // Of the prediction that is going on or was the last: the step in which it began, and where the robot will be when a
  // choice takes effect.
  std::int64_t predicted_from_ = 0;
  Observation later_;
  double later_time_ = -1.0;  // after its beginning; negative: it has not come so far [s]
};

}  // namespace moma
