#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace moma::cli {

/// `moma robot --fit-shapes`.
struct RobotFitOptions {
  std::filesystem::path robot;
  std::filesystem::path output;    ///< a robot file over `robot`; empty: the block goes to stdout
  std::vector<std::string> kinds;  ///< of sphere, capsule, box
  int max_shapes = 3;
  bool force = false;  ///< replace `output`
};

/// Fits, prints, writes; returns the exit code. Throws UsageError, config::ConfigError.
int fit_shapes(const RobotFitOptions& options);

}  // namespace moma::cli
