#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/params.h"

namespace moma {

/// Required distance to objects at rest near the goal. A grasp has the hand nearer to the object than any stop
/// distance. With the distance r of E from the goal,
///
///   kept = min(far, at_goal + slope r)
///
/// so that the required distance shrinks over the last `far`/`slope` metres alone.
struct KeptDistance {
  double at_goal = kInfinity;  ///< [m]; infinite: `far` everywhere
  double slope = 0.0;          ///< [1]
  Vector3 p_WG = Vector3::Zero();

  double most = kInfinity;  ///< required far from the goal if that is less than `far` [m]

  double of(double far, const Vector3& p_WE) const noexcept {
    far = std::min(far, most);
    if (!(at_goal < far)) return far;
    return std::min(far, at_goal + slope * (p_WE - p_WG).norm());
  }
};

/// Returns for each of the robot's shapes whether it is rigid with E: the shapes that a goal may bring near to objects.
std::vector<char> of_hand(const RobotModel& model);

/// Distance between the solids that are rigid with E and objects, with E at its goal: no configuration changes it. One
/// per worker; only allocate() allocates.
class GoalClearance {
 public:
  explicit GoalClearance(const RobotModel& model);

  void allocate(std::size_t num_objects) { states_.assign(num_objects, ObjectState{}); }

  /// Returns the least distance, with E at X_WG, to visible objects at rest; `range` if none is nearer [m].
  /// `kinematics` is the robot in any configuration, `proximity` has its objects; robot and goal are moved together
  /// there, so that E is at the goal. Costs one distance for each pair of solid and object whose balls are nearer than
  /// `range`.
  double least(const Kinematics& kinematics, const Isometry& X_WG, std::span<const ObjectState> objects, double range,
               Proximity& proximity) noexcept;

 private:
  std::vector<int> shapes_;  // rigid with E
  std::vector<ObjectState> states_;
};

}  // namespace moma
