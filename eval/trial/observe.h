#pragma once

#include <vector>

#include "controller/step.h"
#include "world/plant/plant.h"

namespace moma {

/// Fills `observation` with the true state at time t, the only way of information to a controller;
/// world/sensing/sensing.h then disturbs it. Keeps sizes of `observation` that fit, so that only the first step
/// allocates.
void observe(const PlantState& truth, const std::vector<ObjectState>& objects, const GoalState& goal, double t,
             Observation& observation);

}  // namespace moma
