#pragma once

#include <memory>
#include <vector>

#include "controller/model/robot_model.h"

namespace moma {

/// Forward kinematics and Jacobians of one configuration. Owns every buffer and is valid after construction (base at
/// the origin, arm at `ready`). One per worker; update() and all getters are real-time safe.
class Kinematics {
 public:
  explicit Kinematics(std::shared_ptr<const RobotModel> model);

  const RobotModel& model() const noexcept { return *model_; }

  /// base = (x, y, phi) of B in W; q has num_joints() values. O(links).
  void update(const Vector3& base, const Eigen::Ref<const VectorX>& q) noexcept;
  /// Updates the links only: X_WE() and J_WE_W() stay those of the last update(). Half the cost.
  void place(const Vector3& base, const Eigen::Ref<const VectorX>& q) noexcept;

  const Vector3& base() const noexcept { return base_; }
  const VectorX& q() const noexcept { return q_; }
  const Isometry& X_WL(int link) const noexcept { return X_WL_[static_cast<std::size_t>(link)]; }
  const Isometry& X_WB() const noexcept { return X_WL_[0]; }
  const Isometry& X_WE() const noexcept { return X_WE_; }
  Isometry X_WS(const CollisionShape& shape) const noexcept { return X_WL(shape.link) * shape.X_LS; }

  /// 6 x num_velocities(), [angular; linear] at E in world axes, base columns first. The base's angular
  /// column is [z; z x (p_E - p_B)] (Lynch & Park 2017, 11.38, taken at E instead of at B).
  const Matrix6X& J_WE_W() const noexcept { return J_WE_W_; }

  /// Velocity [m/s] per velocity coordinate of the point fixed to `link` that is now at p_W; out is 3 x
  /// num_velocities(). Columns of joints that do not move the link are zero.
  void point_jacobian(int link, const Vector3& p_W, Eigen::Ref<Matrix3X> out) const noexcept;

 private:
  std::shared_ptr<const RobotModel> model_;
  Vector3 base_ = Vector3::Zero();
  VectorX q_;
  std::vector<Isometry, Eigen::aligned_allocator<Isometry>> X_PL_;  // joint at zero, or at its held value
  std::vector<Isometry, Eigen::aligned_allocator<Isometry>> X_WL_;
  Isometry X_WE_ = Isometry::Identity();
  Matrix6X J_WE_W_;
};

/// Jacobian of E for a base that moves freely in the plane: 6 x (3 + num_joints()), [angular; linear] at E in world
/// axes; columns are the base's place (x, y) and heading in W, then the joints. For the configuration of `kinematics`.
void free_jacobian(const Kinematics& kinematics, Eigen::Ref<Matrix6X> J) noexcept;

/// Moves base and q by the constant velocity `v` for `dt` seconds: joints linearly, a differential base
/// along the exact arc, an omnidirectional base along the exact screw of constant (v_x, v_y, omega) in B.
/// phi is not wrapped.
void integrate(const RobotModel& model, Vector3& base, Eigen::Ref<VectorX> q, const Eigen::Ref<const VectorX>& v,
               double dt) noexcept;

/// Rotation vector of R, |result| <= pi; defined at 0 and at pi (there the axis' first non-zero component is positive).
Vector3 log_so3(const Matrix3& R) noexcept;

/// Returns e = [log(R_WG R_WE^T); p_WG - p_WE] in world axes [rad, m].
Vector6 pose_error(const Isometry& X_WE, const Isometry& X_WG) noexcept;

/// Returns the pose nearest to X_WE of those that X_WG allows where the directions [rx ry rz x y z] with `free` not 0,
/// about and along axes of G, are free. With one free rotation, about axis a, or two, about the axes other than a,
/// R_GE = R_swing R_twist with R_twist about a: the goal takes over the twist, or the swing. Places are projected onto
/// the axes of G that are not free.
/// Source: swing-twist decomposition, e.g. Dobrowolski, arXiv 1506.05481. Real-time safe.
Isometry nearest_pose(const Isometry& X_WG, const Vector6& free, const Isometry& X_WE) noexcept;

/// Wraps an angle into [-pi, pi].
double wrapped(double angle) noexcept;

/// Roll, pitch, yaw of R = Rz(yaw) Ry(pitch) Rx(roll), each in [-pi, pi], pitch in [-pi/2, pi/2]. At a pitch of +-pi/2
/// roll and yaw are not unique; one solution is returned.
Vector3 rpy_of(const Matrix3& R) noexcept;

/// Pose of the planar base: rotation by phi about z, translation (x, y, 0).
Isometry base_pose(const Vector3& base) noexcept;

}  // namespace moma
