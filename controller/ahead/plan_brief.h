#pragma once

#include "controller/describe/complete.h"
#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"

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

template <class Visitor>
constexpr void describe(Visitor& v, Of<PlanBrief>) {
  v.member("mode", &PlanBrief::mode, {.text = "what the robot is doing about its goal"});
  v.member("reason", &PlanBrief::reason, {.text = "and why"});
  v.member("attempts", &PlanBrief::attempts, {.range = {0, 1e9}, .text = "choices begun since the start"});
  v.member("clock", &PlanBrief::clock, {.unit = "s", .range = Range::non_negative(), .text = "on the path"});
  v.member("duration", &PlanBrief::duration,
           {.unit = "s", .range = Range::non_negative(), .text = "of the path; 0 without one"});
  v.member("lag", &PlanBrief::lag, {.unit = "m", .range = Range::non_negative(), .text = "behind the path"});
}

static_assert(is_complete<PlanBrief>() && all_worded<PlanMode>() && all_worded<PlanReason>());

}  // namespace moma
