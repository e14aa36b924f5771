#pragma once

#include "controller/model/robot_model.h"
#include "controller/types.h"

namespace moma {

/// Ramp of a base's drive: its velocity follows a command at most at base.max_acceleration, the linear velocity as one
/// vector in base axes, the turn by itself (as in world/plant). Velocities are the base's coordinates of RobotModel,
/// (v, omega) or (v_x, v_y, omega); the unused rest of the three is 0.
class BaseRamp {
 public:
  explicit BaseRamp(const RobotModel& model);

  /// Follows `command` for `dt`, updates `velocity` from the start to the end, and returns the mean velocity in
  /// between: over a ramp from u to u + D within dt, u + D - D/2 min(1, |D|/(a dt)).
  Vector3 follow(const Vector3& command, double dt, Vector3& velocity) const noexcept;

  /// Returns `command`, limited to a change from `before` of `share` times the drive's capability in `dt`.
  Vector3 limited(const Vector3& command, const Vector3& before, double share, double dt) const noexcept;

  /// Time in which the base comes to rest from `velocity` at `share` of its accelerations [s].
  double stopping_time(const Vector3& velocity, double share) const noexcept;

  /// Shares of the drive's accelerations, at most 1: for increasing and for decreasing speed.
  struct Shares {
    double speeding = 1.0;
    double slowing = 1.0;
  };
  void set_shares(const Shares& shares) noexcept { shares_ = shares; }

  /// The base's part of all velocities, and back.
  Vector3 base_of(const VectorX& velocities) const noexcept {
    Vector3 base = Vector3::Zero();
    base.head(dof_) = velocities.head(dof_);
    return base;
  }
  void set_base(const Vector3& base, VectorX& velocities) const noexcept { velocities.head(dof_) = base.head(dof_); }

  int dof() const noexcept { return dof_; }
  /// Acceleration of a coordinate with the whole drive [m/s^2, rad/s^2].
  double acceleration(int i) const noexcept { return i + 1 == dof_ ? acceleration_.y() : acceleration_.x(); }

 private:
  int dof_;
  Vector2 acceleration_;  // [m/s^2, rad/s^2]
  Shares shares_;
};

}  // namespace moma
