#pragma once

#include <memory>

#include "world/plant/plant.h"

namespace moma {

/// Use of the motors' limits in ODE's solver. A step without them is a quarter cheaper; if a motor exceeds its limit,
/// the step is undone and repeated with all limits.
enum class MotorBounds { kWhereTheyBind, kAlways };

/// Rigid bodies, joint motors with effort limits, wheels on the floor (docs/explanation/physics.md).
std::unique_ptr<Plant> make_ode_plant(std::shared_ptr<const RobotModel> model, const World& world,
                                      const SimulationConfig& simulation, const PlantConditions& conditions,
                                      MotorBounds bounds = MotorBounds::kWhereTheyBind);

}  // namespace moma
