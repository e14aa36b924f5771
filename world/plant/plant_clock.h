#pragma once

#include "controller/part_clock.h"

namespace moma {

enum class PlantPart {
  kRest,     ///< setting motors, reading states, integrating motion
  kCollide,  ///< contacts, and the continuous check between steps
  kStep,     ///< the physics engine's step
};

using PlantClock = PartClock<PlantPart>;

}  // namespace moma
