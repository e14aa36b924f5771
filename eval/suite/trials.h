#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "controller/config/node.h"
#include "eval/suite/suite.h"

namespace moma {

// The key `trials` of a suite: a number of worlds, or
//   {until: {metric: success, half_width: 0.02, max: 5000, block: 100}}

/// Sets suite.trials and suite.until; `trials` is then the most that there can be. Throws config::ConfigError.
void read_trials(const config::Node& node, const std::string& key, Suite& suite);

/// What read_trials() reads again.
nlohmann::ordered_json trials_json(const Suite& suite);

}  // namespace moma
