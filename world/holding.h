#pragma once

#include <memory>
#include <optional>
#include <span>

#include "controller/model/kinematics.h"
#include "world/world.h"

namespace moma {

/// Gap up to which an object stands on a support, and gap beyond which it is clear of it [m].
inline constexpr double kStands = 0.01, kLifted = 0.03;
/// Largest depth of contact with the support until the object is clear of it [m].
inline constexpr double kPressed = 0.01;

/// Returns the distance [m] between an object and another one, or the floor (kFloorSupport), in these states.
double gap_between(const World& world, std::span<const ObjectState> states, int object, int support);

/// Returns the solid on which an object stands (Carried::support).
int support_of(const World& world, std::span<const ObjectState> states, int object);

/// Returns what the hand holds from the start; nothing unless world.held. `at_start` is in world.start. Throws
/// std::runtime_error: a link of Held::touch that the robot does not have, or more shapes than Carried::touch takes.
std::optional<Carried> held_at_start(const World& world, const Kinematics& at_start);

/// Returns the robot at the start of the world: a copy that carries what it holds, or `model` itself.
std::shared_ptr<const RobotModel> robot_at_start(const std::shared_ptr<const RobotModel>& model, const World& world);

/// Moves the start, and what the hand holds with it.
void start_from(World& world, const Configuration& start, const std::shared_ptr<const RobotModel>& model);

}  // namespace moma
