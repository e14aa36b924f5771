#pragma once

#include <vector>

#include "controller/model/kinematics.h"

namespace moma {

/// The most that points of a robot's shapes move from a configuration on, while no velocity goes further than it is
/// said to: each joint takes them along by its way times the longest lever that they have about its axis meanwhile,
/// which is the present one, and the way that joints further out have brought them. Distances change by no more.
///
/// Ways of velocities are counted forth and back [m, rad]; vectors of them have num_velocities() values. One per
/// worker; nothing but the constructor takes memory.
class ShapeWays {
 public:
  explicit ShapeWays(const RobotModel& model);

  /// Begins at a configuration.
  void begin(const Kinematics& kinematics) noexcept;
  /// From there on no velocity goes further than this. O(shapes x joints).
  void limit(const VectorX& most) noexcept;

  /// The way of a shape in the world [m] once the velocities have gone so far, each within its limit; and by all of
  /// that.
  double in_world(int shape, const VectorX& gone) const noexcept;
  double most_in_world(int shape) const noexcept { return most_[static_cast<std::size_t>(shape)]; }
  /// The same in height [m]: the base's part is none.
  double in_height(int shape, const VectorX& gone) const noexcept;
  /// The same of one shape as another sees it [m]: what carries both takes no part.
  double between(int first, int second, const VectorX& gone) const noexcept;

  /// The ball around a shape where begin() found it: its centre in the world and its radius [m].
  const Vector3& centre_W(int shape) const noexcept { return centres_W_[static_cast<std::size_t>(shape)]; }
  double radius(int shape) const noexcept { return radii_[static_cast<std::size_t>(shape)]; }

 private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  double by_joints(int shape, int first_joint, const VectorX& gone) const noexcept;

  const RobotModel* model_;
  int base_dof_;
  std::vector<int> moved_by_;  // of a shape: how many joints carry it, which are the first ones
  std::vector<double> radii_, most_;
  std::vector<Vector3> centres_W_;
  Rows levers_at_first_, levers_;  // a row for each shape; of all velocities, those along a line have 1
};

}  // namespace moma
