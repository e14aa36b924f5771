#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "controller/ahead/rollout.h"
#include "controller/plan/planner.h"

namespace moma {

/// What a candidate of a choice came to.
struct PlanCandidate {
  PlanKind kind = PlanKind::kPolicy;
  int index = -1;      ///< of a detour (candidates.h); else -1
  double time = -1.0;  ///< until the goal is reached [s]; negative: it fails, or takes longer than the best before it
  RolloutEnd end = RolloutEnd::kGoesOn;  ///< of a detour: how its prediction ended ...
  double ended = 0.0;                    ///< ... and after how long [s]
};

/// The work of one choice among going on with the direct policy, detours and a planned path, from where the robot will
/// be when the choice takes effect: the quickest counts. Detours are rolled out one after another, each no longer than
/// it can still be the best; then a path is sought that takes less time than the best of them. Work is cut into pieces
/// of one rollout's step or one piece of planning, in checks; the same choice comes out however it is spread.
///
/// One per controller. Construction and reset() may take memory, nothing else does.
class Choice {
 public:
  Choice(std::shared_ptr<const RobotModel> model, const ControllerParams& params);

  void reset(std::span<const ObjectShape> objects);

  /// Begins a choice that takes effect at `from`, where the direct policy would take `direct_time` seconds (negative:
  /// it fails). A robot that moves there comes to rest first where it follows a path. `number` is the choice's, from 1:
  /// draws come from it, and after kTrusted choices detours, which were not kept, give way to paths, as they do for a
  /// goal that is close to an object.
  void begin(const Observation& from, double direct_time, int number) noexcept;
  /// Works until `budget` checks are used up or all is known; `rollout` is of the direct policy. True as long as there
  /// is more to do.
  bool advance(Rollout& rollout, long& budget) noexcept;
  /// Has a path that was found count as it is.
  void hurry() noexcept {
    if (job_ == Job::kPlan) planner_.hurry();
  }
  /// Of a choice that is made: the best of candidates(). Its time is negative where nothing arrives.
  const PlanCandidate& best() const noexcept { return candidates_[best_]; }
  /// The choice as it is remembered.
  PlanVerdict verdict() const noexcept;
  /// What the direct policy remembers where it begins the best detour.
  EscapeState start() const noexcept;
  /// What was tried, the direct policy first.
  std::span<const PlanCandidate> candidates() const noexcept { return candidates_; }

  const Planner& planner() const noexcept { return planner_; }

  static constexpr int kTrusted = 3;

 private:
  enum class Job { kDetours, kPlan, kDone };

  void roll_out(Rollout& rollout, long& budget) noexcept;
  void begin_plan() noexcept;
  void take(const PlanCandidate& candidate) noexcept;

  std::shared_ptr<const RobotModel> model_;
  PlanParams params_;
  EscapeParams escape_;
  Planner planner_;
  Kinematics kinematics_;

  Job job_ = Job::kDone;
  Observation from_;
  WholeConfiguration stand_;  // where the robot comes to rest ...
  double stopping_ = 0.0;     // ... and how long that takes [s]
  std::uint64_t seed_ = 0;
  bool plans_first_ = false;
  int plans_ = 0;         // begun
  int detour_ = 0;        // the next one
  bool rolling_ = false;  // one is being rolled out
  std::vector<PlanCandidate> candidates_;
  std::size_t best_ = 0;
  double least_ = 0.0;  // its time; infinite where nothing arrives [s]
};

/// Where a robot comes to rest that slows down evenly from now on, and the time that takes [s].
double comes_to_rest(const RobotModel& model, const MotionLimits& limits, const Observation& o,
                     WholeConfiguration& c) noexcept;

}  // namespace moma
