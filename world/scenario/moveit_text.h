#pragma once

#include <filesystem>

#include "controller/config/node.h"

namespace moma {

/// Reads the text form of MoveIt's planning scene (.scene, also that without poses of objects) as the tree that its
/// YAML form has. Subframes, triangles and colours are left out. Throws config::ConfigError with file and line.
config::Node read_moveit_text(const std::filesystem::path& file);

}  // namespace moma
