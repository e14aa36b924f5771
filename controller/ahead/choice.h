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

/// A choice of the quicker one of the direct policy and a planned path, from the state in which it takes effect. It
/// searches only a path that is quicker than the policy. The work consists of pieces of planning, counted in checks;
/// its result does not depend on how they are spread over control steps.
///
/// One per controller. Only construction and reset() allocate.
class Choice {
 public:
  Choice(std::shared_ptr<const RobotModel> model, const ControllerParams& params);

  void reset(std::span<const ObjectShape> objects);

  /// Begins a choice that takes effect at `from`, where the direct policy needs `direct_time` seconds (negative: it
  /// fails). A path begins where the robot comes to rest. `number` counts choices from 1 and seeds the draws.
  void begin(const Observation& from, double direct_time, int number) noexcept;
  /// Works until `budget` checks are spent or the choice is complete. True if work is left.
  bool advance(long& budget) noexcept;
  /// Ends the search with the best path so far.
  void hurry() noexcept {
    if (!done_) planner_.hurry();
  }
  /// Result of the choice. If both times are negative, nothing arrives, and the policy goes on.
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
  WholeConfiguration stand_;  // configuration in which the robot comes to rest
  double stopping_ = 0.0;     // time until then [s]
  std::uint64_t seed_ = 0;
  int plans_ = 0;  // number of plans begun
  PlanVerdict verdict_;
};

/// Computes the configuration `c` in which a robot that brakes evenly from now on comes to rest; returns the time [s].
double comes_to_rest(const RobotModel& model, const MotionLimits& limits, const Observation& o,
                     WholeConfiguration& c) noexcept;

}  // namespace moma
