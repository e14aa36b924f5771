#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controller/config/node.h"
#include "eval/suite/suite.h"

namespace moma {

// Strict readers and writers of a suite's small sections; read_x(node of to_json(x)) == x bit for bit.
// All readers throw config::ConfigError naming place and key.

SimulationConfig read_simulation(const config::Node& node, const std::string& key);
/// `simulation` bounds what can be dwelt: a dwell that does not fit into the time limit is an error.
SuccessRule read_success(const config::Node& node, const std::string& key, const SimulationConfig& simulation);
/// Halves of `time` shorter than the control period are an error.
StuckRule read_stuck(const config::Node& node, const std::string& key, const SimulationConfig& simulation);
InfeasibleRule read_infeasible(const config::Node& node, const std::string& key);
SamplesKept read_samples(const config::Node& node, const std::string& key);

/// {NAME: SQL, ...}: names are words of letters, digits and _. The SQL itself is checked by eval/store.
std::vector<std::pair<std::string, std::string>> read_metrics(const config::Node& node, const std::string& key);

nlohmann::ordered_json to_json(const SimulationConfig& simulation);
nlohmann::ordered_json to_json(const SuccessRule& success);
nlohmann::ordered_json to_json(const StuckRule& stuck);
nlohmann::ordered_json to_json(const InfeasibleRule& infeasible);

/// all, failures, none.

/// XXH3-128 of `text`, 32 hex digits, most significant first.
std::string digest_hex(std::string_view text);

/// Digest of the canonical form of `json`: keys sorted, no spaces, numbers in their shortest exact form.
std::string canonical_digest(const nlohmann::ordered_json& json);

}  // namespace moma
