#pragma once

#include "controller/model/robot_model.h"
#include "world/sensing/delay_line.h"
#include "world/sensing/disturbances.h"
#include "world/sensing/streams.h"

namespace moma {

/// The drives between controller and plant (Actuators): nothing moves until the first command is due, and a
/// factor 1 + g is never below 0. A command at its limit may thus be exceeded by the gain's error. A base's command
/// comes late, falls into the deadband or not, takes its gain, lags, and is followed by the ramps: from the velocity u
/// that it follows to w, by no more than part x base.max_acceleration x T, the part being that of slow_down where
/// |w| < |u| or u w < 0, else of speed_up; a linear velocity as one vector.
///
/// Lag: a velocity v follows its command w by v' = (w - v)/lag. What is applied for a period T is the mean of v in it,
/// w + (v - w) (lag/T) (1 - exp(-T/lag)), so that a plant which holds it comes as far. One per trial.
class Actuation {
 public:
  Actuation(const Disturbances& disturbances, const RobotModel& model, const World& world, double control_period);

  /// What the plant gets for the command of step k = 0, 1, 2, ... (each once, in order). Allocates nothing. Valid
  /// until the next call.
  const VectorX& act(long k, const VectorX& command);

 private:
  void follow(const Vector3& wanted);
  void lag_behind();

  DisturbanceStreams streams_;
  Actuators errors_;
  Vector2 acceleration_;  // the base's own [m/s^2, rad/s^2]
  double dt_;
  long joint_jitter_, base_jitter_;  // in periods
  Vector3 followed_ = Vector3::Zero();
  int base_dof_;
  VectorX factor_;   // 1 + g
  VectorX lagging_;  // v of the lag, as the period begins
  VectorX base_, joints_, applied_;
  DelayLine<VectorX> late_base_, late_joints_;
};

}  // namespace moma
