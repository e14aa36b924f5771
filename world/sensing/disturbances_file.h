#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "controller/config/node.h"
#include "world/sensing/disturbances.h"

namespace moma {

/// Reads the section `disturbances` of a suite: a map, a file that holds one (relative to where it is named), or
/// `none`. Throws config::ConfigError.
Disturbances read_disturbances(const config::Node& node, const std::string& key);

/// What differs from the defaults, and nothing else: {} where nothing is on, so that disturbances that do not exist
/// yet cannot change the keys of trials. read_disturbances() gives back the same, bit for bit, where anything is on.
nlohmann::ordered_json to_json(const Disturbances& disturbances);

}  // namespace moma
