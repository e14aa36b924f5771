#pragma once

#include <string>

#include "controller/config/json.h"
#include "controller/config/node.h"
#include "world/world.h"

namespace moma {

Json to_json(const World& world);
/// `what` names the source in messages. Throws config::ConfigError.
World world_from_json(const Json& json, const std::string& what);

/// Strict reader of a world file (specification: world and trace files). Throws config::ConfigError.
World world_from_node(const config::Node& node, const std::string& key);
Motion motion_from_node(const config::Node& node, const std::string& key);

Json to_json(const Motion& motion);
Json to_json(const Moves& moves);

}  // namespace moma
