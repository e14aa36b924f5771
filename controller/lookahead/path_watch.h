#pragma once

#include <memory>
#include <span>
#include <vector>

#include "controller/plan/follow.h"
#include "controller/plan/free_space.h"
#include "controller/plan/plan_params.h"

namespace moma {

/// Checks that the rest of a path stays clear. It checks objects at rest again once one of them comes into sight or has
/// moved since the last check, a few moments of the path in each step. It checks moving objects in every step, at the
/// places that they and the robot will have at the same times. Only set_objects() allocates.
class PathWatch {
 public:
  /// `slope`: growth of the kept distance with the distance from the goal (GoalClearanceParams).
  PathWatch(std::shared_ptr<const RobotModel> model, const DecisionParams& params, const MotionLimits& limits,
            double slope);

  void set_objects(std::span<const ObjectShape> objects);
  /// Discards the results of earlier checks.
  void forget() noexcept;
  /// Checks at most `budget` moments from time t on and subtracts them from it. False if an object at rest is nearer to
  /// the path than a share of its clearance.
  bool holds(const Path& path, const PlanarShift& shift, double t, std::span<const ObjectState> objects,
             long& budget) noexcept;
  /// Returns the first time after t at which a moving object that keeps its velocity is nearer to the robot on its path
  /// than the path's clearance and plan.decisions.meet_room, at most `ahead` [s].
  double met_after(const Path& path, const PlanarShift& shift, double t, double ahead,
                   std::span<const ObjectState> objects, long& budget) noexcept;

 private:
  bool news(std::span<const ObjectState> objects, const PlanarShift& shift) noexcept;

  DecisionParams params_;
  double slope_;
  FreeSpace space_;
  std::vector<ObjectState> looked_at_;  // at the start of the present or last check
  PlanarShift looked_shift_;
  std::vector<ObjectState> moving_;
  Proximity movers_;
  WholeConfiguration point_;
  bool known_ = false;
  double from_ = 0.0;  // the path is checked up to this time [s]
};

}  // namespace moma
