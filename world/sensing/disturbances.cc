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
  reduced.detection.mount = off.detection.mount;
  reduced.detection.axis = off.detection.axis;
  reduced.detection.lost = off.detection.lost;
  if (reduced.detection.missed.probability == 0.0) reduced.detection.missed = {};
  if (reduced.detection.phantoms.count == 0) reduced.detection.phantoms = {};
  if (reduced.base.odometry.slip.rate == 0.0) reduced.base.odometry.slip = {};
  reduced.actuators = off.actuators;
  reduced.payload = off.payload;
  reduced.floor = off.floor;
  reduced.control = off.control;
  return reduced != off;
}

bool acts_with_errors(const Disturbances& disturbances) {
  Actuators reduced = disturbances.actuators;
  reduced.joints.friction = {};
  return reduced != Actuators{};
}

bool moves_with_errors(const Disturbances& disturbances) {
  UnknownPayload payload = disturbances.payload;
  payload.position = {};
  return disturbances.actuators.joints.friction != JointFriction{} || payload != UnknownPayload{} ||
         disturbances.floor != FloorFriction{};
}

long delay_steps(double delay, double control_period) {
  const double periods = std::ceil(delay / control_period * (1.0 - 1e-12) - 1e-9);
  return static_cast<long>(std::max(0.0, periods));
}

}  // namespace moma
