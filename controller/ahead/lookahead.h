#pragma once

#include <memory>
#include <span>
#include <vector>

#include "controller/ahead/path_watch.h"
#include "controller/ahead/plan_state.h"
#include "controller/ahead/rollout.h"
#include "controller/plan/follow.h"
#include "controller/plan/planner.h"
#include "controller/qp/limits.h"

namespace moma {

/// What a candidate of a choice came to.
struct PlanCandidate {
  enum class Kind { kDirect, kPath, kDetour };
  Kind kind = Kind::kDirect;
  int index = 0;       ///< of a detour (candidates.h)
  double time = -1.0;  ///< until the goal is reached [s]; negative: it fails, or takes longer than the best before it
};

/// Decides between the controller's own policy, detours and planned paths, by predicting the first two (rollout.h) and
/// laying the third (planner.h). The quickest counts.
///
/// A step is decide(), which follows from PlanState and the observation alone, and, once the command is found, work():
/// no more than `budget` checks of predictions and plans that are spread over steps. What they lead to is in the state
/// for the next step. While a choice is worked out the robot slows down and stands.
///
/// The direct policy is predicted every `period` seconds. At the start, after a goal's jump and where it is predicted
/// to fail or has stagnated, there is a choice. On a path, the direct policy takes over where it is predicted to take
/// no longer than the path's rest; a robot that does not get on, or whose path is no longer clear, chooses again. Among
/// objects in motion the policy's own ways count: only where it stagnates and none of them is near is there a choice;
/// a goal in motion is the policy's.
///
/// One per controller. Construction and reset() may take memory, nothing else does.
class Lookahead {
 public:
  Lookahead(std::shared_ptr<const RobotModel> model, const ControllerParams& params, double control_period);

  void reset(std::span<const ObjectShape> objects);

  /// Begins a step; `o` is what the controller acts on.
  void decide(const Observation& o) noexcept;
  /// Whether velocities() replace the policy's task in this step: those of a path, or none.
  bool guides() const noexcept { return guides_; }
  const VectorX& velocities() const noexcept { return wanted_; }
  /// Whether the policy's memory of detours is to be `start()` from this step on.
  bool begins_anew() const noexcept { return anew_; }
  const EscapeState& start() const noexcept { return anew_start_; }
  /// Bounds of joints while a path is followed, which keeps away from limits by itself: they are felt later.
  const VelocityBounds& bounds() const noexcept { return bounds_; }
  /// Ends a step: predictions and plans, within the budget. `o` as in decide(), `escape` what the policy remembered of
  /// detours in this step before it acted, `start()` where it began anew.
  void work(const Observation& o, const EscapeState& escape) noexcept;

  const PlanState& state() const noexcept { return state_; }
  /// Goes on from such a state; after reset(). Work in progress begins again.
  void set_state(const PlanState& state) noexcept;

  /// Of the last choice: what was tried, the direct policy first. For inspection.
  std::span<const PlanCandidate> candidates() const noexcept { return candidates_; }
  /// Checks that the last step's work took.
  long checks() const noexcept { return checks_; }
  const Planner& planner() const noexcept { return planner_; }

 private:
  enum class Job { kNone, kPredict, kPlan, kDetours };

  void decide_among_traffic() noexcept;
  void go_direct(PlanReason reason, const EscapeState* start) noexcept;
  void stop(PlanReason reason, double direct_time) noexcept;
  void follow(const Observation& o) noexcept;
  void watch_path(const Observation& o, long& budget) noexcept;
  void begin_prediction(const Observation& o, const EscapeState& escape) noexcept;
  void end_prediction() noexcept;
  void begin_choice(const Observation& o) noexcept;
  void next_detour() noexcept;
  void choose() noexcept;
  void run_rollout(long& budget) noexcept;
  bool stuck() const noexcept;
  bool at_end() const noexcept;
  bool near_mover(const Observation& o) const noexcept;
  std::int64_t periods(double seconds) const noexcept;

  PlanParams params_;
  EscapeParams escape_;
  double dt_;
  BaseType base_;
  Planner planner_;
  PathWatch watch_;
  VelocityBounds bounds_;
  Rollout rollout_;
  Kinematics kinematics_;

  PlanState state_;
  bool guides_ = false, anew_ = false, traffic_ = false;
  EscapeState anew_start_;
  VectorX wanted_;
  PlanarShift shift_;

  Job job_ = Job::kNone;
  long debt_ = 0;  // checks of the last step beyond its budget
  long checks_ = 0;
  bool news_ = false;        // objects came into sight or left it since the last prediction began
  Observation chosen_from_;  // where the robot stood when the choice began
  std::vector<PlanCandidate> candidates_;
  double least_ = 0.0;  // of the candidates so far [s]
  int best_ = 0;        // its index
  int detour_ = 0;
};

}  // namespace moma
