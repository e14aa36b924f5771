#pragma once

#include "world/plant/conditions.h"
#include "world/sensing/disturbances.h"
#include "world/world.h"

namespace moma {

/// Returns the physics of one trial: `disturbances` with draws from the world's own streams.
PlantConditions plant_conditions(const Disturbances& disturbances, const RobotModel& model, const World& world);

}  // namespace moma
