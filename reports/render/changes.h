#pragma once

#include <nlohmann/json.hpp>

namespace moma::reports {

/// Gives the page its `changes`: each version of a controller at a sweep point against the one before, with every
/// setting in which it differs, gains first. Versions have one name but for the store or the number behind it. Settings
/// are what rows of points.sql hold: `parameters`, and disturbances, worlds, times, tolerances and robot beside them.
/// Numbers that are equal are no change, however they are written.
void add_changes(nlohmann::ordered_json& page);

}  // namespace moma::reports
