#include "world/sensing/plant_conditions.h"

#include <algorithm>

#include "world/sensing/streams.h"

namespace moma {

PlantConditions plant_conditions(const Disturbances& disturbances, const RobotModel& model, const World& world) {
  PlantConditions out;
  if (!moves_with_errors(disturbances)) return out;
  using enum DisturbanceSource;
  const DisturbanceStreams streams(world, disturbances.seed);
  const auto draw = [](Draws& draws, double mean, double spread) { return std::max(0.0, draws.normal(mean, spread)); };

  const UnknownPayload& payload = disturbances.payload;
  Draws mass = streams.acting(kPayloadMass);
  out.payload.mass = draw(mass, payload.mass, payload.spread);
  out.payload.p_EP_E = {payload.position[0], payload.position[1], payload.position[2]};
  Draws floor = streams.acting(kFloorFriction);
  out.floor_friction = draw(floor, disturbances.floor.friction, disturbances.floor.spread);
  const JointFriction& of_joints = disturbances.actuators.joints.friction;
  if (of_joints == JointFriction{}) return out;
  Draws friction = streams.acting(kJointFriction);
  out.joint_friction.resize(model.num_joints());
  for (int i = 0; i < model.num_joints(); ++i) {
    // A joint that its own motor cannot move is broken, not disturbed.
    constexpr double kMost = 0.95;
    const double fraction = std::min(kMost, draw(friction, of_joints.effort, of_joints.spread));
    out.joint_friction[i] = fraction * model.joints[static_cast<std::size_t>(i)].effort;
  }
  return out;
}

}  // namespace moma
