#pragma once

#include <cstdint>

#include "controller/ahead/plan_brief.h"
#include "controller/escape_state.h"
#include "controller/plan/path.h"

namespace moma {

/// All that looking ahead remembers from step to step: with an observation, all that decides what is asked of the robot
/// in a step. Work in progress (a prediction or a choice that is spread over steps) is not in it and begins again from
/// it. Times count control periods.
struct PlanState {
  PlanBrief brief;
  std::int64_t steps = 0;     ///< since the start or the goal's last jump
  std::int64_t next = 0;      ///< step of the next prediction
  std::int64_t stop_end = 0;  ///< step at which a stop has lasted long enough; of a choice, at which it ended
  std::int64_t commit = 0;    ///< step up to which `brief.going_on` goes on: what is chosen takes effect there
  bool chosen = false;        ///< the choice is made and waits for that: `path`, or else a detour from `start` on
  std::int64_t mark = 0;      ///< step of the last progress along the path ...
  double mark_clock = 0.0;    ///< ... and where that was on it [s]
  int stagnations = 0;        ///< the policy's, up to which nothing is news
  double direct_time = -1.0;  ///< predicted of the direct policy from the choice on [s]; negative: it fails
  bool left_path = false;     ///< the stop interrupted a path
  bool fresh = false;         ///< the direct policy begins anew, as `start` says, in the next step
  EscapeState start;
  bool has_goal = false;
  Isometry X_WG = Isometry::Identity();  ///< the goal's, in the step before
  int known = 0;                         ///< objects that were seen in the step before
  Path path;                             ///< of no motions where there is none
};

}  // namespace moma
