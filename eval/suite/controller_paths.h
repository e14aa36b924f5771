#pragma once

#include <nlohmann/json.hpp>

#include "controller/config/node.h"
#include "plugin/host/plugin.h"

namespace moma {

/// The keys that say where the code of a controller lies and decide nothing else, in absolute paths: beside what the
/// controller resolves to, read_suite_controller() needs them to read it again.
nlohmann::ordered_json paths_of(const Plugin& plugin, const nlohmann::ordered_json& controller_resolved);

/// Puts them in the place of those in an entry, which can then be written into any folder.
void anchor_paths(config::Node& entry, const Plugin& plugin, const nlohmann::ordered_json& controller_resolved);

}  // namespace moma
