#pragma once

#include "eval/cli/robot_fit.h"

namespace moma::cli {

/// `moma robot URDF`: a first robot file over the URDF that `options.robot` names, to `options.output` or stdout, with
/// fitted shapes on request (they need an output). Returns the exit code. Throws UsageError, config::ConfigError.
int draft_robot_file(const RobotFitOptions& options, bool fit, bool lenient);

}  // namespace moma::cli
