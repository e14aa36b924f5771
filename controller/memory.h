#pragma once

#include <vector>

#include "controller/escape_state.h"
#include "controller/lookahead/plan_state.h"
#include "controller/map/map_box.h"
#include "controller/safe/prediction_memory.h"
#include "controller/step.h"

namespace moma {

/// Memory of detours: their state, and the last step's goal, by which jumps of the goal are detected.
struct EscapeMemory {
  EscapeState state;
  GoalState last_goal;
  bool has_goal = false;  ///< there was a last step
};

/// Memory of a controller between steps: with an observation it determines the command. reset() fixes all sizes but the
/// map's: copies among equal sizes do not allocate.
struct ControllerMemory {
  EscapeMemory escape;
  PredictionMemory prediction;  ///< empty without prediction
  PlanState plan;               ///< of the look-ahead; initial without it
  std::vector<MapBox> map;      ///< boxes of the map, which stay until the next frame; its cells are not part of it
};

}  // namespace moma
