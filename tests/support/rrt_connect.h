#pragma once

#include <span>

#include "controller/plan/free_space.h"
#include "controller/plan/whole_body_ik.h"

namespace moma::test {

/// The way that OMPL's RRT-Connect found, after OMPL's own shortening.
struct RrtConnectWay {
  bool found = false;
  long checks = 0;       ///< spent until then
  double seconds = 0.0;  ///< of the processor
  double time = 0.0;     ///< of the way's edges [s]
  double length = 0.0;   ///< of the way in joint space [rad]
};

/// Asks OMPL's RRT-Connect for a way from `start` to one of the first `most_goals` goal configurations. Configurations,
/// edges and distances are those of `space`, which must have its objects and clearances; trees, samples and shortcuts
/// are OMPL's. The base stays within 1.5 m of the rectangle around the start and the goal at X_WG.
RrtConnectWay ask_rrt_connect(FreeSpace& space, const WholeConfiguration& start, const Isometry& X_WG,
                              std::span<const GoalConfiguration> goals, int most_goals, double step, long most_checks);

}  // namespace moma::test
