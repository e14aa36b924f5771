#pragma once

#include <nlohmann/json.hpp>

#include "controller/config/node.h"
#include "plugin/host/plugin.h"

namespace moma {

/// Returns the keys that locate a controller's code, in absolute paths. They determine nothing else;
/// read_suite_controller() needs them besides the resolved controller.
nlohmann::ordered_json paths_of(const Plugin& plugin, const nlohmann::ordered_json& controller_resolved);

/// Replaces the paths of an entry by these, so that the entry can be written into any folder.
void anchor_paths(config::Node& entry, const Plugin& plugin, const nlohmann::ordered_json& controller_resolved);

}  // namespace moma
