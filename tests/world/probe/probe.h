#pragma once

#include <memory>
#include <nlohmann/json.hpp>

#include "controller/model/robot_model.h"
#include "world/world.h"

// What the physics probe answers: each function takes one request and returns one line of its answer. Poses are
// {"position": [x, y, z], "rotation": [row by row]}; units are SI.
namespace moma::probe {

/// The robot of a request: `robot` is the path of a robot file; `held` true bolts its base to the world;
/// `max_acceleration` replaces the base's.
std::shared_ptr<const RobotModel> robot_of(const nlohmann::json& request);

/// The resolved robot, link by link and not merged, and the numbers of the plant that are not the robot's own:
/// wheels, casters, friction, gravity.
nlohmann::json model(const nlohmann::json& request);

/// Torques that hold the arm against gravity at each of `configurations`, read from ODE's joint feedback.
nlohmann::json gravity(const nlohmann::json& request);

/// The arm under `torques` (one list for each of its steps of `step` seconds) from `q` at rest: q after each step.
nlohmann::json torque(const nlohmann::json& request);

/// The plant under `commands` (one for each control period of `period` seconds) among `objects`. Ends at the first
/// contact with an object where `until_contact` is true. Answers states, contacts and the least clearance.
nlohmann::json drive(const nlohmann::json& request);

/// CPU time of `steps` physics steps of the plant.
nlohmann::json cost(const nlohmann::json& request);

}  // namespace moma::probe
