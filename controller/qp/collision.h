#pragma once

#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/params.h"
#include "controller/qp/problem.h"
#include "controller/step.h"

namespace moma {

/// Rows n^T (v_robot - v_object) >= -zeta, zeta = xi (d - d_s)/(d_i - d_s), for objects, the floor and the robot
/// itself. Signs follow "d grows along n" (checked by differencing d), where the source's formulas for objects and
/// for two links use opposite directions. One per worker; only allocate() takes memory.
class CollisionRows {
 public:
  CollisionRows(const RobotModel& model, const CollisionParams& params);

  /// Sizes the buffers for so many objects. Returns the most rows that add() can append: max_pairs, and up to
  /// kMaxEnds for each of them where end rows are on.
  int allocate(int num_objects);
  /// Ranges within which pairs matter; negative for a kind that is switched off.
  ProximityRanges ranges() const noexcept;

  /// Sorts the pairs that are closer than their d_i nearest first by d - d_s (ties: by index).
  void select(std::span<const ProximityPair> pairs) noexcept;

  /// Appends the rows of the first max_pairs selected: objects, floor, self, each in that order; after an object's row
  /// those of its ends (end_rows.h) where it is near enough. Rows that nothing the robot can do would change
  /// (max |n^T J| < 1e-9) are left out and counted.
  void add(const Kinematics& kinematics, Proximity& proximity, std::span<const ObjectState> states,
           QpProblem& problem) noexcept;

  /// The pairs of the last select() within their d_i, sorted nearest first; more than max_pairs if there were.
  std::span<const ProximityPair> sorted() const noexcept { return {sorted_.data(), sorted_.size()}; }
  int left_out() const noexcept { return left_out_; }

 private:
  struct Key {
    double order;
    int index;
  };
  const DamperParams& damper(PairKind kind) const noexcept;
  bool fill(const Kinematics& kinematics, const ProximityPair& pair, std::span<const ObjectState> states, int end,
            QpProblem& problem) noexcept;
  void add_ends(const Kinematics& kinematics, Proximity& proximity, const ProximityPair& pair,
                std::span<const ObjectState> states, QpProblem& problem) noexcept;

  const RobotModel* model_;
  CollisionParams params_;
  std::vector<Key> keys_;
  std::vector<ProximityPair> sorted_;
  Matrix3X J_first_, J_second_;
  VectorX row_;
  int left_out_ = 0;
};

/// xi (d - d_s)/(d_i - d_s) [m/s]: the speed at which a distance may shrink.
double approach_speed(const DamperParams& params, double d) noexcept;

}  // namespace moma
