#pragma once

#include "controller/part_clock.h"

namespace moma {

/// Parts of what a plant does.
enum class PlantPart {
  kRest,     ///< motors set, states read, motion integrated
  kCollide,  ///< who touches whom, and whether anything could have on the way
  kStep,     ///< the physics engine's step
};

using PlantClock = PartClock<PlantPart>;

}  // namespace moma
