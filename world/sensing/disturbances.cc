#include "world/sensing/disturbances.h"

#include <algorithm>
#include <cmath>

namespace moma {

bool senses_with_errors(const Disturbances& disturbances) {
  Disturbances reduced = disturbances;
  const Disturbances off;
  reduced.seed = off.seed;
  for (PoseSensing* poses : {&reduced.objects, &reduced.goal}) {
    poses->frame = SensingFrame::kWorld;
    poses->resting_is_known = false;
  }
  reduced.detection.sensor = off.detection.sensor;
  reduced.detection.known_at_start = off.detection.known_at_start;
  reduced.actuators = off.actuators;
  reduced.physics = off.physics;
  return reduced != off;
}

bool acts_with_errors(const Disturbances& disturbances) { return disturbances.actuators != ActuatorErrors{}; }

bool moves_with_errors(const Disturbances& disturbances) {
  PhysicsErrors reduced = disturbances.physics;
  reduced.payload_position = {};
  return reduced != PhysicsErrors{};
}

long delay_steps(double delay, double control_period) {
  const double periods = std::ceil(delay / control_period * (1.0 - 1e-12) - 1e-9);
  return static_cast<long>(std::max(0.0, periods));
}

}  // namespace moma
