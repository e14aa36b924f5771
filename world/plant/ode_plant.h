#pragma once

#include <memory>

#include "world/plant/plant.h"

namespace moma {

/// When ODE's solver is told of the motors' limits. Unbounded motors make a step a quarter cheaper; where one would
/// need more than it has, the step is taken back and made again with all bounds.
enum class MotorBounds { kWhereTheyBind, kAlways };

/// Rigid bodies, joint motors with effort limits, wheels on the floor (docs/explanation/physics.md).
std::unique_ptr<Plant> make_ode_plant(std::shared_ptr<const RobotModel> model, const World& world,
                                      const SimulationConfig& simulation, const PlantConditions& conditions,
                                      MotorBounds bounds = MotorBounds::kWhereTheyBind);

}  // namespace moma
