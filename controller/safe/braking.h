#pragma once

#include "controller/model/robot_model.h"
#include "controller/params.h"
#include "controller/types.h"

namespace moma {

/// How fast a robot can lose its velocity: the accelerations that it is allowed (limits.acceleration, resolved), of an
/// omnidirectional base's linear pair together.
class Deceleration {
 public:
  Deceleration(const RobotModel& model, const VectorX& acceleration_limit, bool pair_together);

  /// The base brakes with so much of its accelerations (1: all, as from birth).
  void set_slowing(double share) noexcept;
  /// Of c qdot, when every velocity brakes: sum |c_i| a_i, of a linear pair a |(c_x, c_y)|. Infinite where a velocity
  /// that counts may change at once.
  double along(const Eigen::Ref<const VectorX>& c) const noexcept;
  /// Times in which each velocity of u can come to rest, 0 where at once [s].
  void stopping_times(const VectorX& u, VectorX& times) const noexcept;

 private:
  VectorX acceleration_;
  Vector3 base_ = Vector3::Zero();  // its part of these with all of the drive
  int base_dof_;
  bool pair_;
};

/// Largest speed from which one stops within `room`, braking at `deceleration` after `reaction`: the root of
/// v t + v^2/(2 a) = room. 0 without room; infinite where the deceleration is.
double stoppable_speed(double room, double deceleration, double reaction) noexcept;

/// Speed from which a base, braking after `reaction` as its drive can, stops between the distance at which its rows
/// begin, `influence`, and `stop`; not above its own [m/s]. Its own without rows that know how it brakes.
double foreseen_speed(const RobotModel& model, const CollisionParams& params) noexcept;

}  // namespace moma
