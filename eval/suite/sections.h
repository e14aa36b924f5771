#pragma once

#include <string>

#include "controller/config/node.h"
#include "eval/suite/suite.h"

namespace moma {

// Strict readers of the suite's sections that determine no trial. All throw config::ConfigError with place and key.

/// Reads {NAME: SQL, ...} and its places into Suite::metrics. A name consists of letters, digits and _. eval/store
/// checks the SQL.
void read_metrics(const config::Node& node, const std::string& key, Suite& suite);

/// Reads a text of one line or more.
std::string read_notes(const config::Node& node, const std::string& key);

// The key `trials` of a suite: a number of worlds, or
//   {until: {metric: success, half_width: 0.02, max: 5000, block: 100}}

/// Sets suite.trials and suite.until; with `until`, `trials` is the maximum. Throws config::ConfigError.
void read_trials(const config::Node& node, const std::string& key, Suite& suite);

/// Returns the input of read_trials().
Json trials_json(const Suite& suite);

}  // namespace moma
