#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <vector>

#include "eval/run/replay.h"
#include "reports/render/report.h"

namespace moma::cli {

/// What the URDF of a stored robot says that it looks like, with its meshes read from where package:// and file://
/// lead. `robots`: robot files; where one names the same URDF, its packages and its folder are looked in as well. A
/// robot with a mesh that cannot be found or read has no look, and a line on standard error says why. Throws
/// config::ConfigError: a robot file that cannot be read.
reports::Look robot_look(const std::vector<std::filesystem::path>& robots);

/// Simulates a stored trial's motion and the rows of its QP again, from the store alone. `suites` has to outlive it. It
/// throws store::StoreError and config::ConfigError where the store or what it names cannot be read.
reports::Simulate simulated_again(run::StoredSuites& suites);

/// What reports ask about collisions, answered by the simulation's own rules: see run::known_before_contact().
std::optional<double> time_known(const reports::HitObject& question);

/// --look and --shapes.
void add_look_options(CLI::App& command, std::vector<std::filesystem::path>& robots, bool& shapes);

}  // namespace moma::cli
