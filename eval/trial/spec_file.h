#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "controller/config/node.h"
#include "eval/trial/spec.h"

namespace moma {

// Strict readers and writers of what a trial needs besides robot and controller; read_x(node of to_json(x)) == x bit
// for bit. All readers throw config::ConfigError naming place and key.

SimulationConfig read_simulation(const config::Node& node, const std::string& key);
/// `simulation` bounds what can be dwelt: a dwell that does not fit into the time limit is an error.
SuccessRule read_success(const config::Node& node, const std::string& key, const SimulationConfig& simulation);
/// Halves of `time` shorter than the control period are an error.
StuckRule read_stuck(const config::Node& node, const std::string& key, const SimulationConfig& simulation);
InfeasibleRule read_infeasible(const config::Node& node, const std::string& key);

nlohmann::ordered_json to_json(const SimulationConfig& simulation);
nlohmann::ordered_json to_json(const SuccessRule& success);
nlohmann::ordered_json to_json(const StuckRule& stuck);
nlohmann::ordered_json to_json(const InfeasibleRule& infeasible);

}  // namespace moma
