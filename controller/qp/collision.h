#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/params.h"
#include "controller/qp/problem.h"
#include "controller/safe/braking.h"
#include "controller/safe/uncertainty.h"
#include "controller/step.h"

namespace moma {

/// Stop distances of parts of the robot from objects at rest [m].
struct RestingStops {
  double hand = 0.0, arm = 0.0, base = 0.0;
};

/// Damper rows n^T (v_robot - v_object) >= -zeta, zeta = xi (d - d_s)/(d_i - d_s), for objects, the floor and the robot
/// itself. With `braking`, zeta is at most the speed from which the robot can still stop (stoppable_speed() of d - d_s)
/// at a share of its deceleration along the row, before the object's own velocity is subtracted: dampers with
/// acceleration limits, as Del Prete's bounds of joints (IEEE RA-L 3(1), 2018). With `uncertainty` d is reduced by its
/// margin, and for objects in motion by `moving_room`. Signs follow "d grows along n" (checked by differencing d),
/// whereas the article's formulas for objects and for two links use opposite directions. One per worker; only
/// allocate() allocates.
class CollisionRows {
 public:
  /// References must outlive the rows.
  CollisionRows(const RobotModel& model, const CollisionParams& params, const Deceleration& deceleration,
                const Uncertainty& uncertainty);

  /// Sizes the buffers for so many objects. Returns the largest number of rows that add() can append, at most
  /// max_pairs.
  int allocate(int num_objects);
  /// Ranges within which pairs matter; negative for a kind that is switched off.
  ProximityRanges ranges() const noexcept;

  /// Sorts the pairs that are closer than their d_i, nearest first by d - d_s (ties: by index).
  void select(std::span<const ProximityPair> pairs, std::span<const ObjectState> states) noexcept;

  /// Appends the rows of the first max_pairs selected pairs: objects, floor, self. Rows that no motion of the robot
  /// changes (max |n^T J| < 1e-9) are left out and counted. `spreads`: of the objects' positions, empty if they are
  /// exact.
  void add(const Kinematics& kinematics, std::span<const ObjectState> states, std::span<const PlaceSpread> spreads,
           QpProblem& problem) noexcept;

  /// Sets the dampers of space that no sensor has seen (ObjectState::seen).
  void keep_from_unseen(const DamperParams& unseen) noexcept { unseen_ = unseen; }
  /// Sets the stop distances d_s from objects at rest, at most the configured one, and the `rate` of approach
  /// xi/(d_i - d_s), at least the configured one [1/s].
  void keep_from_resting(const RestingStops& stops, double rate) noexcept;
  /// Raises the bound of `braking` for objects at rest, the floor and the robot itself to the speed of approach of
  /// these velocities, those of a path that keeps more than d_s. Null: no path. The vector must outlive add().
  void allow(const VectorX* path_velocities) noexcept { path_velocities_ = path_velocities; }

  /// The pairs of the last select() within their d_i, sorted nearest first; there may be more than max_pairs.
  std::span<const ProximityPair> sorted() const noexcept { return {sorted_.data(), sorted_.size()}; }
  int left_out() const noexcept { return left_out_; }

 private:
  const DamperParams& damper(PairKind kind) const noexcept;
  const DamperParams& damper(const ProximityPair& pair, std::span<const ObjectState> states) const noexcept;
  bool fill(const Kinematics& kinematics, const ProximityPair& pair, std::span<const ObjectState> states,
            std::span<const PlaceSpread> spreads, QpProblem& problem) noexcept;

  const RobotModel* model_;
  CollisionParams params_;
  enum Part : std::uint8_t { kHand, kArm, kBase };
  std::vector<Part> part_;               // of the robot to which each shape belongs
  std::array<DamperParams, 3> resting_;  // of each part, for objects at rest
  DamperParams unseen_;
  const VectorX* path_velocities_ = nullptr;
  std::vector<std::pair<double, std::size_t>> keys_;  // of pairs: d - d_s and index
  std::vector<ProximityPair> sorted_;
  Matrix3X J_;
  VectorX row_;
  const Deceleration& deceleration_;
  const Uncertainty& uncertainty_;
  int left_out_ = 0;
};

/// Returns xi (d - d_s)/(d_i - d_s) [m/s]: the largest speed at which a distance may shrink.
double approach_speed(const DamperParams& params, double d) noexcept;

}  // namespace moma
