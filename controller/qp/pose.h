#pragma once

#include <memory>
#include <span>

#include "controller/model/proximity.h"
#include "controller/qp/collision.h"
#include "controller/qp/limits.h"
#include "controller/qp/problem.h"
#include "controller/qp/separation.h"
#include "controller/qp/terms.h"
#include "controller/qp/upright.h"
#include "controller/safe/goal_clearance.h"
#include "controller/situation.h"

namespace moma {

/// Pairs of shapes near the robot, by one distance query.
struct Near {
  std::span<const ProximityPair> pairs;  ///< within their distance of influence d_i, nearest first by d - d_s
  ProximityRanges ranges;                ///< d_i of each kind of pair; negative without rows
};

/// Problem of one step, with its inputs. References are to the buffers of QpPoser until its next pose().
struct Posed {
  const QpTask& asked;
  const Bounds& bounds;
  const QpProblem& problem;
  Near near;
  double stop;  ///< stop distance d_s of objects at rest, which shrinks near the goal [m]
};

/// Poses the QP of one step: bounds, objective, rows. A step is look(), then pose() for each task: a pose() depends on
/// its arguments and the last look() alone. One per controller; only set_objects() allocates.
class QpPoser {
 public:
  /// `params` as resolved(); they and the model must outlive the poser.
  QpPoser(std::shared_ptr<const RobotModel> model, const ControllerParams& params, double control_period);

  void set_objects(std::span<const ObjectShape> objects);

  /// Measures the distances that rows and detours depend on.
  Near look(const Situation& now) noexcept;
  Posed pose(const QpTask& asked, const Situation& now) noexcept;
  /// Writes the smallest command within the bounds that follow from the known elements of q and qdot
  /// (VelocityBounds::brake()).
  void brake(const VectorX& q, const VectorX& qdot, VectorX& command) noexcept {
    limits_.brake(q, qdot, bounds_, command);
  }
  /// Removes rows and objective, for a step that solves no QP.
  void clear() noexcept;

  const VelocityBounds& limits() const noexcept { return limits_; }
  const QpTask& asked() const noexcept { return asked_; }
  const Bounds& bounds() const noexcept { return bounds_; }
  const QpProblem& problem() const noexcept { return problem_; }
  const Objective& objective() const noexcept { return objective_; }
  const CollisionRows& collision() const noexcept { return collision_; }
  double stop() const noexcept { return stop_; }

 private:
  Near near() const noexcept;
  double stop_near_goal(const QpTask& asked, const Situation& now) noexcept;

  std::shared_ptr<const RobotModel> model_;
  const ControllerParams& params_;
  VelocityBounds limits_;
  Proximity proximity_;
  Deceleration deceleration_;
  Uncertainty uncertainty_;
  CollisionRows collision_;
  SeparationRows separation_;
  UprightRow upright_;
  GoalClearance goal_clearance_;
  double stop_;
  QpTask asked_;
  Bounds bounds_;
  Objective objective_;
  QpProblem problem_;
};

}  // namespace moma
