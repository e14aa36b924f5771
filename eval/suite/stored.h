#pragma once

#include "eval/suite/controller_entry.h"
#include "eval/suite/suite.h"

namespace moma {

/// suite_from_resolved() with permission for the suite's plugins; the overload without permission refuses them. Throws
/// config::ConfigError, PluginRefused.
Suite suite_from_resolved(const nlohmann::ordered_json& resolved, Plugins plugins);

}  // namespace moma
