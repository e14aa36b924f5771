#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "controller/lookahead/plan_brief.h"
#include "controller/params.h"
#include "controller/plan/direct_way.h"
#include "controller/plan/planner.h"
#include "controller/step.h"

namespace moma {

/// How velocities fall to zero: all of them in the same time, or each as quickly as it may, as in a robot that is told
/// to stop.
enum class Rest { kEvenly, kEach };

/// A choice of the quicker one of the direct policy and a path, from the state in which it takes effect. The path is a
/// direct way if one is free and quicker than the policy, otherwise a planned one that is quicker. The work consists of
/// pieces of planning, counted in checks; its result does not depend on how they are spread over control steps.
///
/// A goal or object in motion counts as resting at its meeting place: where its twist takes it in the time in which the
/// base drives straight to its present place (for a fixed arm, in `decisions.meet_time`). Ways lead to the goal's
/// meeting place and keep clear of those of objects.
///
/// Ways lead around space that no sensor has seen (map.unseen.around), or through it if none is found.
///
/// One per controller. Only construction and reset() allocate.
class Choice {
 public:
  Choice(std::shared_ptr<const RobotModel> model, const ControllerParams& params);

  void reset(std::span<const ObjectShape> objects);

  /// Sets the axes of the goal, for a goal with free directions, whose pose in an observation is the nearest one.
  void set_goal_axes(const Matrix3& R_WG) noexcept { R_WG_ = R_WG; }
  /// Keeps the tool upright on all ways and paths.
  void keep_upright(const std::optional<Upright>& upright) noexcept {
    direct_way_.keep_upright(upright);
    planner_.keep_upright(upright);
  }
  /// Share of the base's accelerations with which the next choice plans.
  void set_drive(double share) noexcept { drive_ = share; }
  /// Begins a choice that takes effect at `from`, where the direct policy needs `direct_time` seconds (negative: it
  /// fails). `number` counts choices from 1 and seeds the draws of a plan. Without `plans` only a direct way counts.
  void begin(const Observation& from, double direct_time, int number, bool plans = true) noexcept;
  /// Begins the search for a direct way from `from` alone; direct_way() goes on with it.
  void begin_way(const Observation& from) noexcept;
  /// Works until `budget` checks are spent or the choice is complete. True if work is left.
  bool advance(long& budget) noexcept;
  /// Ends the search with the best path so far.
  void hurry() noexcept {
    if (!done_ && !on_way_) planner_.hurry();
  }
  /// Result of the choice. If both times are negative, nothing arrives, and the policy goes on.
  const PlanVerdict& verdict() const noexcept { return verdict_; }

  /// True if the chosen path is a direct way.
  bool is_direct() const noexcept { return direct_; }
  Path path() const noexcept {
    Path path = direct_ ? direct_way_.path() : planner_.path();
    path.meets = in_motion(from_.goal);
    return path;
  }
  const Planner& planner() const noexcept { return planner_; }
  DirectWay& direct_way() noexcept { return direct_way_; }
  /// Place and velocity of `o`; velocities of a robot that stands are zero.
  MotionState motion_of(const Observation& o) const noexcept;
  /// Moves the robot of `o` there.
  void put(const MotionState& motion, Observation& o) const noexcept;

 private:
  void begin_way() noexcept;
  bool go_through() noexcept;
  void end_way() noexcept;
  void begin_plan() noexcept;
  // The path to a goal close to an object begins at rest.
  Rest rest() const noexcept { return direct_way_.close_goal() ? Rest::kEach : Rest::kEvenly; }

  std::shared_ptr<const RobotModel> model_;
  PlanParams params_;
  double depth_;  // up to which ways may enter space that no sensor has seen [m]; 0: they go through it
  DirectWay direct_way_;
  Planner planner_;

  bool done_ = true;
  double drive_ = 1.0;
  bool plans_paths_ = true, on_way_ = false, direct_ = false;
  Observation from_;     // space that no sensor has seen is smaller by `depth_`
  bool around_ = false;  // ways lead around that
  Matrix3 R_WG_ = Matrix3::Identity();
  WholeConfiguration stand_;  // configuration in which the robot comes to rest
  double stopping_ = 0.0;     // time until then [s]
  std::uint64_t seed_ = 0;
  int plans_ = 0;  // number of plans begun
  PlanVerdict verdict_;
};

/// Computes the configuration `c` in which a robot comes to rest whose velocities fall from now on at constant rates.
/// Returns the time until then [s].
double comes_to_rest(const RobotModel& model, const MotionLimits& limits, const Observation& o, Rest rest,
                     WholeConfiguration& c) noexcept;

}  // namespace moma
