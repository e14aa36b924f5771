#pragma once

#include <span>
#include <utility>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/params.h"
#include "controller/qp/problem.h"
#include "controller/safe/braking.h"
#include "controller/safe/uncertainty.h"

namespace moma {

/// Separation rows: slow the robot down towards moving objects, by the speed and separation monitoring of ISO/TS
/// 15066:2016, 5.5.4, whose protective separation distance is that of ISO 13855, S = K T + C, with the robot's own
/// motion. The required distance between a shape of the robot and a moving object is
///
///   S_p = S_H + S_R + S_S + C + Z,   S_H = v_H (T_R + T_S),  S_R = v_R T_R,  S_S = v_R^2/(2 a),  T_S = v_R/a
///
/// v_H: speed of the object's nearest point along the line between the two, at least `speed` (1.6 m/s if a person's is
/// unknown, ISO 13855). v_R = c qdot: the robot's, with c the row. a: `share` of the robot's deceleration along the row
/// (braking.h). T_R, C: `reaction`, `intrusion`. Z: margin of the distance (uncertainty.h), 0 without `uncertainty`; it
/// replaces Z_d and Z_r. Solved for the robot's speed the row is
///
///   c qdot <= separation_speed(d - C - Z, v_H, a, T_R) >= 0
///
/// It asks the robot to stop, never to yield: collision rows do that, unchanged. Objects at rest have none.
/// An option of a controller and no safety function: safe-controller.md. One per worker; only allocate() allocates.
class SeparationRows {
 public:
  /// References must outlive the rows.
  SeparationRows(const RobotModel& model, const CollisionParams& params, const Deceleration& deceleration,
                 const Uncertainty& uncertainty);

  /// Sizes the buffers for so many objects. Returns the largest number of rows that add() can append: max_pairs,
  /// besides those of CollisionRows.
  int allocate(int num_objects);

  /// Appends rows of pairs within `range` whose objects move, the least remaining speed first (ties: by shape, then
  /// object), without rows that no velocity within the robot's limits violates. With moving objects it makes a query of
  /// its own: spans of earlier ones are void. `spreads` as in CollisionRows.
  void add(const Kinematics& kinematics, Proximity& proximity, std::span<const ObjectState> states,
           std::span<const PlaceSpread> spreads, QpProblem& problem) noexcept;

 private:
  double fill(const Kinematics& kinematics, const ProximityPair& pair, std::span<const PlaceSpread> spreads) noexcept;

  const RobotModel* model_;
  SeparationParams params_;
  bool on_;
  std::size_t max_rows_;
  const Deceleration& deceleration_;
  const Uncertainty& uncertainty_;
  VectorX most_;  // largest values of all velocities
  std::vector<ObjectState> moving_;
  std::vector<std::pair<double, std::size_t>> chosen_;  // remaining speeds and indices of pairs
  Matrix3X J_;
  VectorX row_;
};

/// Returns the largest v_R >= 0 [m/s] with v_H (T_R + v_R/a) + v_R T_R + v_R^2/(2 a) <= room [m]; 0 without a solution,
/// or if an argument is not a number. An infinite deceleration stops at once; with T_R = 0 as well there is no bound.
double separation_speed(double room, double v_H, double deceleration, double reaction) noexcept;

}  // namespace moma
