#pragma once

#include <cstdint>

#include "controller/describe/enumeration.h"
#include "controller/escape_state.h"
#include "controller/plan/path.h"
#include "controller/step.h"

namespace moma {

/// What a controller that looks ahead is doing. In `stop` and `choose` it asks for no motion.
enum class PlanMode {
  kDirect,  ///< the controller's own policy
  kFollow,  ///< a path
  kStop,    ///< slows down, to choose
  kChoose   ///< works out a path and predicts detours
};

constexpr auto words(Of<PlanMode>) { return std::to_array<std::string_view>({"direct", "follow", "stop", "choose"}); }

/// Why the mode is what it is.
enum class PlanReason {
  kStart,       ///< a motion, or a goal that jumped: the choice comes first
  kArrives,     ///< the direct policy is predicted to arrive
  kQuicker,     ///< what was chosen is predicted to arrive soonest
  kFails,       ///< the direct policy is predicted to touch something, to stagnate or not to arrive
  kStagnates,   ///< it has stagnated
  kNoPath,      ///< nothing better was found
  kPathEnds,    ///< the path is at its end
  kNoProgress,  ///< the robot does not get on along the path
  kPathBroken,  ///< what is seen now is in the path's way
  kTraffic,     ///< the goal or something near moves
};

constexpr auto words(Of<PlanReason>) {
  return std::to_array<std::string_view>({"start", "arrives", "quicker", "fails", "stagnates", "no_path", "path_ends",
                                          "no_progress", "path_broken", "traffic"});
}

/// The part of it that a sample carries.
struct PlanBrief {
  PlanMode mode = PlanMode::kDirect;
  PlanReason reason = PlanReason::kStart;
  int attempts = 0;       ///< choices begun since reset()
  double clock = 0.0;     ///< on the path [s]
  double duration = 0.0;  ///< of the path [s]; 0 without one
  double lag = 0.0;       ///< behind the path [m]
};

/// All that looking ahead remembers from step to step: with an observation, all that decides what is asked of the robot
/// in a step. Work in progress (a prediction or a choice that is spread over steps) is not in it and begins again from
/// it. Times count control periods.
struct PlanState {
  PlanBrief brief;
  std::int64_t steps = 0;       ///< since the start or the goal's last jump
  std::int64_t next = 0;        ///< step of the next prediction
  std::int64_t stop_end = 0;    ///< step at which a stop has lasted long enough
  std::int64_t mark = 0;        ///< step of the last progress along the path ...
  double mark_clock = 0.0;      ///< ... and where that was on it [s]
  int stagnations = 0;          ///< the policy's, up to which nothing is news
  double direct_time = -1.0;    ///< predicted of the direct policy when the stop began [s]; negative: it fails
  bool left_path = false;       ///< the stop interrupted a path
  bool fresh = false;           ///< the direct policy begins anew, as `start` says, in the next step
  EscapeState start;
  bool has_goal = false;
  Isometry X_WG = Isometry::Identity();  ///< the goal's, in the step before
  int known = 0;                         ///< objects that were seen in the step before
  Path path;                             ///< of no motions where there is none
};

}  // namespace moma
