#pragma once

#include <span>
#include <string_view>

#include "controller/model/robot_model.h"

namespace moma {

/// Properties of a kind of base. Only its entry in robot_model.cc and its drive in world/plant distinguish the kinds.
/// Immutable, of static storage. Nothing here allocates or throws.
struct BaseKind {
  /// Names of its velocity coordinates: linear ones in base axes, forwards and then to the left, the turn last. Empty
  /// for a fixed base.
  std::span<const std::string_view> velocities;
  /// Names of its wheels, in the order of wheel_row().
  std::span<const std::string_view> wheel_names;
  /// True if its wheels stand in front and at the rear.
  bool wheelbase = false;
  /// Speed of one wheel per velocity coordinate [rad/m, 1], 0 beyond them; null without wheels.
  Vector3 (*wheel_row)(const Wheels& wheels, int wheel) noexcept = nullptr;

  int dof() const noexcept { return static_cast<int>(velocities.size()); }
  /// Number of linear coordinates: 0, 1 or 2.
  int num_linear() const noexcept { return dof() > 0 ? dof() - 1 : 0; }
  /// True if it moves sideways: drives then bound (v_x, v_y) as one vector.
  bool lateral() const noexcept { return num_linear() == 2; }
  /// True if it moves along its heading only, and has to turn for other directions.
  bool nonholonomic() const noexcept { return num_linear() == 1; }

  /// (v_x, v_y, omega) in base axes from the leading dof() coordinates of `v`, and back: without v_y for a base that
  /// does not move sideways.
  Vector3 velocity_B(const Eigen::Ref<const VectorX>& v) const noexcept {
    if (dof() == 0) return Vector3::Zero();
    return {v[0], lateral() ? v[1] : 0.0, v[dof() - 1]};
  }
  void set_coordinates(const Vector3& velocity_B, Eigen::Ref<VectorX> v) const noexcept {
    if (dof() == 0) return;
    v[0] = velocity_B.x();
    if (lateral()) v[1] = velocity_B.y();
    v[dof() - 1] = velocity_B.z();
  }
};

const BaseKind& kind_of(BaseType type) noexcept;

/// 2, 4 or 0.
int num_wheels(const MobileBase& base) noexcept;
/// Writes the wheel speeds [rad/s] for the base's part of `velocity`: left, right; or FL, FR, RL, RR. Returns their
/// number, 0 without wheels.
int wheel_speeds(const MobileBase& base, const Eigen::Ref<const VectorX>& velocity, Eigen::Vector4d& speeds) noexcept;

}  // namespace moma
