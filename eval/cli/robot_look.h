#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "reports/render/mesh_data.h"

namespace moma::cli {

/// What the URDF of a stored robot says that it looks like, with its meshes read from where package:// and file://
/// lead. `robots`: robot files; where one names the same URDF, its packages and its folder are looked in as well. A
/// robot with a mesh that cannot be found or read has no look, and a line on standard error says why. Throws
/// config::ConfigError: a robot file that cannot be read.
reports::Look robot_look(const std::vector<std::filesystem::path>& robots);

/// --look and --shapes.
void add_look_options(CLI::App& command, std::vector<std::filesystem::path>& robots, bool& shapes);

}  // namespace moma::cli
