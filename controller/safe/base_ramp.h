#pragma once

#include "controller/model/robot_model.h"
#include "controller/types.h"

namespace moma {

/// What a base's drive makes of a command: its velocity follows no faster than base.max_acceleration, the linear
/// velocity as one vector in base axes, the turn by itself (as world/plant has it). Velocities are the base's
/// coordinates of RobotModel, (v, omega) or (v_x, v_y, omega), the rest of the three unused and 0.
class BaseRamp {
 public:
  explicit BaseRamp(const RobotModel& model);

  /// Follows `command` for `dt`: `velocity` is that at the beginning, and afterwards that at the end. Returns the mean
  /// velocity of that time: over a ramp from u to u + D within dt, u + D - D/2 min(1, |D|/(a dt)).
  Vector3 follow(const Vector3& command, double dt, Vector3& velocity) const noexcept;

  /// `command`, no further from the one before than `share` of what the drive can follow in `dt`.
  Vector3 limited(const Vector3& command, const Vector3& before, double share, double dt) const noexcept;

  /// Time in which the base comes to rest from `velocity` at `share` of its accelerations [s].
  double stopping_time(const Vector3& velocity, double share) const noexcept;

  /// Shares of its accelerations with which the drive follows, at most 1: where its speed grows, and where it falls.
  struct Shares {
    double speeding = 1.0;
    double slowing = 1.0;
  };
  void set_shares(const Shares& shares) noexcept { shares_ = shares; }

  int dof() const noexcept { return dof_; }

 private:
  int dof_;
  Vector2 acceleration_;  // [m/s^2, rad/s^2]
  Shares shares_;
};

}  // namespace moma
