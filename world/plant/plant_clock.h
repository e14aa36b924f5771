#pragma once

#include <array>
#include <string_view>

#include "controller/part_clock.h"

namespace moma {

/// Parts of what a plant does.
enum class PlantPart {
  kRest,     ///< motors set, states read, motion integrated
  kCollide,  ///< who touches whom, and whether anything could have on the way
  kStep,     ///< the physics engine's step
};
constexpr auto words(Of<PlantPart>) { return std::to_array<std::string_view>({"rest", "collide", "step"}); }
static_assert(all_worded<PlantPart>());

using PlantClock = PartClock<PlantPart>;

}  // namespace moma
