#pragma once

#include <memory>
#include <string>
#include <vector>

#include "controller/config/json.h"
#include "controller/config/node.h"
#include "controller/model/robot_model.h"

namespace moma::config {

/// A robot as read, and everything that decided it: `resolved` holds the URDF's text, hull vertices and the
/// self-collision pairs found, so that robot_from_resolved() needs no other file and gives the same model.
struct LoadedRobot {
  std::shared_ptr<const RobotModel> model;
  Json resolved;
  std::vector<std::string> warnings;  ///< what is doubtful: missing inertias or efforts, contact at `ready`, ...
  std::vector<std::string> notes;     ///< what was decided on the way: joints held, pairs left out
};

/// Reads a robot file (configs/robots/*.yaml). Throws ConfigError naming the place.
LoadedRobot load_robot(const fs::path& file);

/// The value of a suite's or case's `robot` key: the path of a robot file (relative to the file that names it),
/// or a map with the same keys, or a resolved robot.
LoadedRobot read_robot(const Node& node, const std::string& key);

LoadedRobot robot_from_resolved(const Json& resolved);

/// Returns the rotation of `rpy`: about the fixed axes x, y, z in turn, as in URDF [rad].
Matrix3 rotation_of(const Vector3& rpy);

}  // namespace moma::config
