#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "files/output_file.h"

namespace moma::cli {

/// `moma robot --fit-shapes`.
struct RobotFitOptions {
  std::filesystem::path robot;
  std::filesystem::path output;    ///< a robot file over `robot`; empty: the block goes to stdout
  std::vector<std::string> kinds;  ///< of sphere, capsule, box
  int max_shapes = 3;
  files::Replace replace = files::Replace::kOwn;  ///< of `output`
};

/// Shapes found for a robot file.
struct FittedShapes {
  std::string block;      ///< `collision` of a robot file, with how well it fits as a comment
  std::string report;     ///< that comment, for a terminal
  std::string collision;  ///< `collision` alone
  std::vector<std::string> warnings;
};

/// Of `options.robot`; nothing is printed or written. Throws config::ConfigError.
FittedShapes fitted_shapes(const RobotFitOptions& options);

/// Fits, prints, writes; returns the exit code. Throws UsageError, config::ConfigError.
int fit_shapes(const RobotFitOptions& options);

/// A robot file is edited by hand: none gives way by itself.
const files::Kind& robot_file_kind();

/// Throws UsageError where `options.output` is the robot itself, files::OutputError where it may not be replaced.
void check_output(const RobotFitOptions& options);

}  // namespace moma::cli
