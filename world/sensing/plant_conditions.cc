#include "world/sensing/plant_conditions.h"

#include <algorithm>

#include "world/sensing/streams.h"

namespace moma {

PlantConditions plant_conditions(const Disturbances& disturbances, const RobotModel& model, const World& world) {
  PlantConditions out;
  if (!moves_with_errors(disturbances)) return out;
  using enum DisturbanceSource;
  const PhysicsErrors& errors = disturbances.physics;
  const DisturbanceStreams streams(world, disturbances.seed);
  const auto draw = [](Draws& draws, const Spread& spread) {
    return std::max(0.0, draws.normal(spread.mean, spread.spread));
  };

  Draws mass = streams.acting(kPayloadMass);
  out.payload.mass = draw(mass, errors.payload_mass);
  out.payload.p_EP_E = {errors.payload_position[0], errors.payload_position[1], errors.payload_position[2]};
  Draws floor = streams.acting(kFloorFriction);
  out.floor_friction = draw(floor, errors.floor_friction);
  if (errors.joint_friction == Spread{}) return out;
  Draws friction = streams.acting(kJointFriction);
  out.joint_friction.resize(model.num_joints());
  for (int i = 0; i < model.num_joints(); ++i) {
    // A joint that its own motor cannot move at all is broken, not disturbed.
    constexpr double kMost = 0.95;
    const double fraction = std::min(kMost, draw(friction, errors.joint_friction));
    out.joint_friction[i] = fraction * model.joints[static_cast<std::size_t>(i)].effort;
  }
  return out;
}

}  // namespace moma
