#pragma once

#include <string>

#include "controller/config/json.h"
#include "controller/config/node.h"
#include "world/sensing/disturbances.h"

namespace moma {

/// Reads the section `disturbances` of a suite: a map, a file with one (relative to the file that names it), or `none`.
/// Throws config::ConfigError.
Disturbances read_disturbances(const config::Node& node, const std::string& key);

/// Returns only the members that differ from the defaults; {} if nothing is on. Future disturbances therefore do not
/// change the keys of trials. read_disturbances() restores the same, bit for bit, if anything is on.
Json to_json(const Disturbances& disturbances);

}  // namespace moma
