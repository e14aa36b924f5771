#pragma once

#include <string>

#include "controller/config/node.h"
#include "eval/suite/suite.h"

namespace moma {

// Strict readers of the sections of a suite that decide no trial. All throw config::ConfigError naming place and key.

SamplesKept read_samples(const config::Node& node, const std::string& key);

/// {NAME: SQL, ...} into Suite::metrics, with where they stand: names are words of letters, digits and _. The SQL
/// itself is checked by eval/store.
void read_metrics(const config::Node& node, const std::string& key, Suite& suite);

/// Text of one line or more.
std::string read_notes(const config::Node& node, const std::string& key);

}  // namespace moma
