#pragma once

#include <memory>

#include "world/plant/plant.h"

namespace moma {

/// Rigid bodies, joint motors with effort limits, wheels on the floor (docs/explanation/physics.md).
std::unique_ptr<Plant> make_ode_plant(std::shared_ptr<const RobotModel> model, const World& world,
                                      const SimulationConfig& simulation, const PlantConditions& conditions);

}  // namespace moma
