#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "controller/ahead/plan_brief.h"
#include "controller/params.h"
#include "controller/plan/planner.h"
#include "controller/step.h"

namespace moma {

/// The work of one choice between going on with the direct policy and a planned path, from where the robot will be when
/// the choice takes effect: the quicker one counts. Only a path that takes less time than the policy is sought. Work is
/// cut into pieces of planning, counted in checks; the same choice comes out however it is spread.
///
/// One per controller. Construction and reset() may allocate, nothing else does.
class Choice {
 public:
  Choice(std::shared_ptr<const RobotModel> model, const ControllerParams& params);

  void reset(std::span<const ObjectShape> objects);

  /// Begins a choice that takes effect at `from`, where the direct policy would take `direct_time` seconds (negative:
  /// it fails). A robot that moves there comes to rest first where it follows a path. `number` is the choice's, from 1:
  /// draws come from it.
  void begin(const Observation& from, double direct_time, int number) noexcept;
  /// Works until `budget` checks are used up or the choice is made. True as long as there is more to do.
  bool advance(long& budget) noexcept;
  /// Ends the search with the best path so far.
  void hurry() noexcept {
    if (!done_) planner_.hurry();
  }
  /// What the choice came to. Both times are negative if nothing arrives; the policy then goes on.
  const PlanVerdict& verdict() const noexcept { return verdict_; }

  const Planner& planner() const noexcept { return planner_; }

 private:
  void begin_plan() noexcept;

  std::shared_ptr<const RobotModel> model_;
  double settle_;    // time from a path's end to the goal [s]
  int close_plans_;  // plans of one choice for a goal that is close to an object, each with more work
  Planner planner_;

  bool done_ = true;
  Observation from_;
  WholeConfiguration stand_;  // where the robot comes to rest ...
  double stopping_ = 0.0;     // ... and how long that takes [s]
  std::uint64_t seed_ = 0;
  int plans_ = 0;  // begun
  PlanVerdict verdict_;
};

/// Where a robot comes to rest that slows down evenly from now on, and the time that takes [s].
double comes_to_rest(const RobotModel& model, const MotionLimits& limits, const Observation& o,
                     WholeConfiguration& c) noexcept;

}  // namespace moma
