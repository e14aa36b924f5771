#pragma once

#include <nlohmann/json.hpp>

#include "controller/config/reader.h"
#include "controller/escape_state.h"
#include "controller/params.h"

namespace moma::config {

/// `escape: none`, or a map: there, detours are on unless it says `enabled: false`.
void read_escape(MapReader& in, EscapeParams& escape);
/// `vortex: none`, or a map, which switches it on.
void read_vortex(MapReader& in, VortexParams& vortex);

/// What a controller remembers, any part of which may be absent: {best, idle, stagnations, side, detour, remaining,
/// target, circulation}, as a trace and `moma solve` write it and a case file takes it (`state.escape`).
EscapeState read_escape_state(const Node& node, const std::string& key);
nlohmann::ordered_json to_json(const EscapeState& state);

/// What the first two read back, every number included: stagnation is watched for the vortex even without detours.
nlohmann::ordered_json to_json(const EscapeParams& escape);
nlohmann::ordered_json to_json(const VortexParams& vortex);

}  // namespace moma::config
