#pragma once

#include <memory>

#include "world/plant/plant.h"

namespace moma {

/// Pairs that are checked for contact: those that the broad phase keeps (reach_watch.h), or all. Both find the same
/// contacts.
enum class ContactChecks { kWhereSomethingMayTouch, kAll };

/// The command is the velocity: joints move by q + command t, the base along its exact arc. Contacts are checked at
/// least every 5 ms of motion. With `stops` a joint stops at its limit.
std::unique_ptr<Plant> make_kinematic_plant(std::shared_ptr<const RobotModel> model, const World& world,
                                            bool stops = false,
                                            ContactChecks checks = ContactChecks::kWhereSomethingMayTouch);

}  // namespace moma
