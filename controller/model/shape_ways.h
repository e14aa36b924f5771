#pragma once

#include <vector>

#include "controller/model/kinematics.h"

namespace moma {

/// Upper bounds of the travel of points of a robot's shapes, from a configuration and limits of each velocity's travel.
/// A joint moves them by its travel times their longest lever about its axis, which is the present lever plus the
/// travel by joints further out. Distances change by no more.
///
/// Travels of velocities count both directions [m, rad]; vectors of them have num_velocities() values. One per worker;
/// only the constructor allocates.
class ShapeWays {
 public:
  explicit ShapeWays(const RobotModel& model);

  void begin(const Kinematics& kinematics) noexcept;
  /// Limits the travel of each velocity from there. O(shapes x joints).
  void limit(const VectorX& most) noexcept;

  /// Travel of a shape in the world [m] for these travels of the velocities, each within its limit; and for the limits.
  double in_world(int shape, const VectorX& gone) const noexcept;
  double most_in_world(int shape) const noexcept { return most_[static_cast<std::size_t>(shape)]; }
  /// The same in height [m], without the base's part.
  double in_height(int shape, const VectorX& gone) const noexcept;
  /// The same of one shape relative to another [m], without motions that carry both.
  double between(int first, int second, const VectorX& gone) const noexcept;

  /// Bounding ball of a shape at begin(): its centre in the world and its radius [m].
  const Vector3& centre_W(int shape) const noexcept { return centres_W_[static_cast<std::size_t>(shape)]; }
  double radius(int shape) const noexcept { return radii_[static_cast<std::size_t>(shape)]; }

 private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  double by_joints(int shape, int first_joint, const VectorX& gone) const noexcept;

  const RobotModel* model_;
  int base_dof_;
  std::vector<int> moved_by_;  // per shape: number of joints that carry it, which are the first ones
  std::vector<double> radii_, most_;
  std::vector<Vector3> centres_W_;
  Rows levers_at_first_, levers_;  // one row per shape; over all velocities, linear ones have 1
};

}  // namespace moma
