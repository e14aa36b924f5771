#pragma once

#include "controller/model/robot_model.h"
#include "world/sensing/delay_line.h"
#include "world/sensing/disturbances.h"
#include "world/sensing/streams.h"

namespace moma {

/// The drives between controller and plant (Actuators). Nothing moves before the first command arrives. A factor 1 + g
/// is never below 0, and a gain error may take a command beyond its limit. A base's command is delayed, passes the
/// deadband, takes its gain, and lags; ramps then follow it. From the present velocity u to w the change per period is
/// at most share x base.max_acceleration x T, with the share slow_down if |w| < |u| or u w < 0, else speed_up; a linear
/// velocity is one vector.
///
/// Lag: a velocity v follows its command w by v' = (w - v)/lag. The applied velocity of a period T is the mean of v, w
/// + (v - w) (lag/T) (1 - exp(-T/lag)), so that a plant that holds it travels the same distance. One object per trial.
class Actuation {
 public:
  Actuation(const Disturbances& disturbances, const RobotModel& model, const World& world, double control_period);

  /// Returns the plant's command for the controller's command of step k = 0, 1, 2, ... (each once, in order). Allocates
  /// nothing. Valid until the next call.
  const VectorX& act(long k, const VectorX& command);

 private:
  void follow(const Vector3& wanted);
  void lag_behind();

  DisturbanceStreams streams_;
  Actuators errors_;
  Vector2 acceleration_;  // of the base [m/s^2, rad/s^2]
  double dt_;
  Vector3 followed_ = Vector3::Zero();
  int base_dof_;
  VectorX factor_;   // 1 + g
  VectorX lagging_;  // v of the lag at the start of the period
  VectorX base_, joints_, applied_;
  LateLine<VectorX> late_base_, late_joints_;
};

}  // namespace moma
