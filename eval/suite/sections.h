#pragma once

#include <string>

#include "controller/config/reader.h"
#include "eval/suite/suite.h"

namespace moma {

/// Reads the keys that determine no trial: name, trials, samples, metrics and notes. Throws config::ConfigError with
/// place and key.
///   trials: a number of worlds, or {until: {metric: success, half_width: 0.02, max: 5000, block: 100}}; with `until`,
///           Suite::trials is the maximum
///   metrics: {NAME: SQL, ...}; a name consists of letters, digits and _. eval/store checks the SQL
///   notes: a text of one line or more
void read_whole(config::MapReader& in, Suite& suite);

/// Returns the key `trials` of a suite.
Json trials_json(const Suite& suite);

}  // namespace moma
