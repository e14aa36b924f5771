#pragma once

#include <memory>
#include <span>
#include <vector>

#include "controller/plan/follow.h"
#include "controller/plan/free_space.h"
#include "controller/plan/plan_params.h"

namespace moma {

/// Whether the rest of a path keeps clear of what is known now. Objects at rest are looked at again as soon as one of
/// them has come into sight or is seen elsewhere than when the path was last found clear: a few moments of the path a
/// step, until its end. Objects in motion are looked at in every step, where they and the robot will be at the same
/// times. Nothing takes memory but set_objects().
class PathWatch {
 public:
  /// `slope`: growth of what a path keeps with the distance from its goal (GoalClearanceParams).
  PathWatch(std::shared_ptr<const RobotModel> model, const DecisionParams& params, const MotionLimits& limits,
            double slope);

  void set_objects(std::span<const ObjectShape> objects);
  /// All that was known is to be looked at again.
  void forget() noexcept;
  /// Looks at no more than `budget` moments from time t on, and takes them from it. False where objects at rest are
  /// nearer to the path than part of its clearance.
  bool holds(const Path& path, const PlanarShift& shift, double t, std::span<const ObjectState> objects,
             long& budget) noexcept;
  /// The first time after t, `ahead` seconds at most, at which an object in motion, going on as it does, will be nearer
  /// than `clearance` to the robot on its path; `ahead` where there is none [s after t].
  double met_after(const Path& path, const PlanarShift& shift, double t, double ahead, double clearance,
                   std::span<const ObjectState> objects, long& budget) noexcept;

 private:
  bool news(std::span<const ObjectState> objects, const PlanarShift& shift) noexcept;

  DecisionParams params_;
  double slope_;
  FreeSpace space_;
  std::vector<ObjectState> looked_at_;  // as they were when the look began that is going on, or was the last
  PlanarShift looked_shift_;
  std::vector<ObjectState> moving_;
  Proximity movers_;
  WholeConfiguration point_;
  bool known_ = false;
  double from_ = 0.0;  // the path is looked at up to here; its end where all is
};

}  // namespace moma
