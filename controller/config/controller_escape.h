#pragma once

#include <nlohmann/json.hpp>

#include "controller/config/reader.h"
#include "controller/params.h"

namespace moma::config {

/// `escape: none`, or a map: there, detours are on unless it says `enabled: false`.
void read_escape(MapReader& in, EscapeParams& escape);
/// `vortex: none`, or a map, which switches it on.
void read_vortex(MapReader& in, VortexParams& vortex);

/// What the two read back, every number included: stagnation is watched for the vortex even without detours.
nlohmann::ordered_json to_json(const EscapeParams& escape);
nlohmann::ordered_json to_json(const VortexParams& vortex);

}  // namespace moma::config
