#pragma once

#include "world/plant/conditions.h"
#include "world/sensing/disturbances.h"
#include "world/world.h"

namespace moma {

/// The physics of one trial: what `disturbances` say, drawn from the world's own streams.
PlantConditions plant_conditions(const Disturbances& disturbances, const RobotModel& model, const World& world);

}  // namespace moma
