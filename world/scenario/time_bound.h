#pragma once

#include <limits>
#include <memory>

#include "controller/model/robot_model.h"
#include "world/world.h"

namespace moma {

/// Limits of one coordinate; an infinite one does not bound.
struct RampLimits {
  double speed = 0.0;  ///< > 0 [m/s, rad/s]
  double acceleration = std::numeric_limits<double>::infinity();
  double jerk = std::numeric_limits<double>::infinity();
};

/// Returns the least time from rest to rest over a way of length `way` >= 0 [s]: speed along an S-curve, whose parts
/// vanish where a limit is not reached. Source: Biagiotti & Melchiorri, Trajectory Planning for Automatic Machines and
/// Robots, 2008, 3.4; the tests compare it with Ruckig's results.
double rest_to_rest(double way, const RampLimits& limits) noexcept;

struct TimeBound {
  double time = std::numeric_limits<double>::infinity();  ///< [s]; infinite if no configuration at the goal was found
  Configuration end;                                      ///< of the quickest motion, E at the goal
};

/// Returns the least time that was found from rest at the start to rest at the world's goal [s], for the robot alone:
/// objects, floor, contact with itself, torques and every controller's gains are left out. Joints keep their limits
/// of position, speed, acceleration and jerk, and each takes its own quickest time. The base keeps its speeds and
/// accelerations: an omnidirectional one moves straight and turns meanwhile; a differential one that drives in one
/// direction has the heading of the straight line from start to end somewhere on its way (mean value theorem), so that
/// it turns there and from there to its last heading, and drives at least the straight line.
///
/// A motion's time follows from its last configuration. Descent looks for the quickest one at the goal from the witness
/// and from `tries` configurations about the start, ten times as many if none comes to the goal. 20 times the
/// tries find ones that are 1 to 3 % quicker in the mean (test), at most 1.6 times in single worlds. Deterministic.
/// Cost: about 40 us a try.
TimeBound time_bound(const std::shared_ptr<const RobotModel>& model, const World& world, int tries = 40);

}  // namespace moma
