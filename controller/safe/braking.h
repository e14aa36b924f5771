#pragma once

#include "controller/model/robot_model.h"
#include "controller/params.h"
#include "controller/types.h"

namespace moma {

/// Deceleration of a robot: its allowed accelerations (limits.acceleration, resolved), with an omnidirectional base's
/// linear pair taken together.
class Deceleration {
 public:
  Deceleration(const RobotModel& model, const VectorX& acceleration_limit, bool pair_together);

  /// Sets the share of its accelerations with which the base brakes (1 at construction).
  void set_slowing(double share) noexcept;
  /// Deceleration of c qdot if every velocity brakes: sum |c_i| a_i, for a linear pair a |(c_x, c_y)|. Infinite if a
  /// velocity with c_i != 0 has no limit.
  double along(const Eigen::Ref<const VectorX>& c) const noexcept;
  /// Times in which each velocity of u comes to rest, 0 without a limit [s].
  void stopping_times(const VectorX& u, VectorX& times) const noexcept;

 private:
  VectorX acceleration_;
  Vector3 base_ = Vector3::Zero();  // the base's part with the whole drive
  int base_dof_;
  bool pair_;
};

/// Largest speed from which one stops within `room`, braking at `deceleration` after `reaction`: the root of v t +
/// v^2/(2 a) = room. 0 without room; infinite for infinite deceleration.
double stoppable_speed(double room, double deceleration, double reaction) noexcept;

}  // namespace moma
