#pragma once

#include "controller/plan/path.h"
#include "controller/step.h"

namespace moma {

/// A rotation by `turn` about the world's z axis, then a translation, from a path's axes to the present world axes.
struct PlanarShift {
  Vector2 move = Vector2::Zero();
  double turn = 0.0;

  WholeConfiguration of(const WholeConfiguration& c) const noexcept;
  MotionState of(const MotionState& motion) const noexcept;
  /// Returns a change of a configuration in the path's axes.
  WholeConfiguration turned_back(const WholeConfiguration& change) const noexcept;
  /// Returns the pose that the shift moves to X.
  Isometry back(const Isometry& X) const noexcept;
};

/// Returns the shift that moves the goal of the path to the goal as measured now: odometry drifts, and the path follows
/// the goal. It is zero for a fixed robot.
PlanarShift shift_of_goal(bool mobile, const Isometry& X_WG_then, const Isometry& X_WG_now) noexcept;

/// One step of following.
struct FollowStep {
  double rate = 0.0;  ///< rate of the path's clock, 0 to 1
  double lag = 0.0;   ///< distance of the robot from its target on the path [m]
};

/// Returns the lag of a robot at `o` behind a configuration `c` of a path: the largest of the base's distance and of
/// the errors of its heading and joints, these times the gains `plan.follow` [m].
double path_lag(const MotionLimits& limits, const PlanParams& params, const WholeConfiguration& c,
                const Observation& o) noexcept;

/// Computes the velocities `u` of base and joints at time t of the path for a robot at `o`. The clock's rate is
/// clip(1.5 - lag / params.lag, 0, most_rate). With the path's velocity v_r, omega_r and the errors e_x, e_y in base
/// axes and e_theta: a differential base does v = v_r cos e_theta + k e_x, omega = omega_r + k e_theta + `across` v_r
/// e_y (after Kanayama, Kimura, Miyazaki & Noguchi, ICRA 1990, whose Lyapunov function shows it stable for v_r > 0 with
/// v_r sin e_theta in place of v_r e_theta; v_r < 0 mirrors it); an omnidirectional one and the joints do feed-forward
/// + k e.
FollowStep follow_path(const MotionLimits& limits, const PlanParams& params, const Path& path, double t, double dt,
                       double most_rate, const PlanarShift& shift, const Observation& o, VectorX& u) noexcept;

}  // namespace moma
