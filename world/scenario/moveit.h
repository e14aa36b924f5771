#pragma once

#include <map>
#include <set>
#include <string>

#include "controller/config/node.h"
#include "controller/config/paths.h"
#include "controller/model/kinematics.h"
#include "world/scenario/foreign_parts.h"

namespace moma::foreign {

/// Kinds of change that an import makes to a file's contents, and the names of the objects of each.
using Changes = std::map<std::string, std::set<std::string>>;

/// Reads a planning scene, as YAML or JSON of the message; `family` names one that has no name. `at_ready`: the robot.
/// Throws config::ConfigError.
Scene read_scene(const Kinematics& at_ready, const config::Node& root, const std::string& family, Changes& changes);

/// Reads a motion plan request with a goal for joints. Throws config::ConfigError.
Request read_request(const Kinematics& at_ready, const config::Node& root, Changes& changes);

/// Reads the text form of a planning scene (.scene, also that without poses of objects) as the tree that its YAML form
/// has. Subframes and colours are left out. Throws config::ConfigError with file and line.
config::Node read_moveit_text(const fs::path& file);

}  // namespace moma::foreign
