#pragma once

#include "controller/types.h"

namespace moma {

/// All that a controller remembers from step to step. Times count control periods, never a clock.
struct EscapeState {
  double best = -1.0;  ///< V at its last progress [m]; negative: no step taken yet
  double idle = 0.0;   ///< time without progress since [s]
  int stagnations = 0;
  int side = 0;            ///< +1 or -1 once the first stagnation has chosen it: where detours turn first
  bool detour = false;     ///< on a detour,
  bool around = false;     ///< and that one around the obstacles: the target is its next corner
  double remaining = 0.0;  ///< of the detour [s]
  Vector3 target_W = Vector3::Zero();
  int circulation = 0;  ///< sigma of the vortex: +1, -1, or 0 as long as none was needed
};

}  // namespace moma
