#pragma once

#include <string>

#include "controller/config/json.h"
#include "controller/config/node.h"
#include "eval/trial/spec.h"

namespace moma {

// Strict readers and writers of a trial's sections besides robot and controller; read_x(node of to_json(x)) == x bit
// for bit. All readers throw config::ConfigError with place and key.

SimulationConfig read_simulation(const config::Node& node, const std::string& key);
/// A dwell longer than the time limit of `simulation` is an error.
SuccessRule read_success(const config::Node& node, const std::string& key, const SimulationConfig& simulation);
/// A half of `time` shorter than the control period is an error.
StuckRule read_stuck(const config::Node& node, const std::string& key, const SimulationConfig& simulation);
InfeasibleRule read_infeasible(const config::Node& node, const std::string& key);

Json to_json(const SimulationConfig& simulation);
Json to_json(const SuccessRule& success);
Json to_json(const StuckRule& stuck);
Json to_json(const InfeasibleRule& infeasible);

}  // namespace moma
