#pragma once

#include "controller/ahead/plan_state.h"
#include "controller/escape_state.h"
#include "controller/safe/prediction_memory.h"
#include "controller/step.h"

namespace moma {

/// What is remembered of detours: where they are, and the last step's goal, by which one that jumps is told.
struct EscapeMemory {
  EscapeState state;
  GoalState last_goal;
  bool has_goal = false;  ///< there was a last step
};

/// All that a controller remembers from step to step: with an observation, all that decides a command. Sizes are fixed
/// by reset(): copies among equal sizes take no memory.
struct ControllerMemory {
  EscapeMemory escape;
  PredictionMemory prediction;  ///< empty where prediction is off
  PlanState plan;               ///< of looking ahead; as at the start where it is off
};

}  // namespace moma
