#pragma once

#include <string>

#include "controller/config/json.h"
#include "controller/config/node.h"
#include "eval/trial/spec.h"

namespace moma {

// Strict readers and writer of a trial's sections besides robot and controller; what is written is read back bit for
// bit. All readers throw config::ConfigError with place and key.

SimulationConfig read_simulation(const config::Node& node, const std::string& key);
/// A dwell longer than the time limit of `simulation` is an error.
SuccessRule read_success(const config::Node& node, const std::string& key, const SimulationConfig& simulation);
/// A half of `time` shorter than the control period is an error.
StuckRule read_stuck(const config::Node& node, const std::string& key, const SimulationConfig& simulation);
InfeasibleRule read_infeasible(const config::Node& node, const std::string& key);

/// The spec's sections beside robot and controller by their names in a suite; `disturbances` if there are any.
Json sections_json(const TrialSpec& spec);

}  // namespace moma
