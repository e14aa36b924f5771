#pragma once

#include <vector>

#include "controller/step.h"
#include "world/plant/plant.h"

namespace moma {

/// The one way by which a controller learns of the world: fills `observation` from the truth at time t, which
/// world/sensing/sensing.h then makes what is sensed. Sizes of `observation` are kept where they fit, so that a step
/// allocates nothing after the first.
void observe(const PlantState& truth, const std::vector<ObjectState>& objects, const GoalState& goal, double t,
             Observation& observation);

}  // namespace moma
