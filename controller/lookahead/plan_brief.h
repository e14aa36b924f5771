#pragma once

#include "controller/describe/complete.h"
#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"
#include "controller/types.h"

namespace moma {

/// Activity of a controller with look-ahead. In `stop`, `choose` and `set_out` it commands no motion.
enum class PlanMode {
  kDirect,  ///< the controller's own policy
  kFollow,  ///< a path
  kStop,    ///< slows down, to choose
  kChoose,  ///< works out a path
  kSetOut   ///< stands and looks for a direct way, at the start of a motion
};

constexpr auto words(Of<PlanMode>) {
  return std::to_array<std::string_view>({"direct", "follow", "stop", "choose", "set_out"});
}

/// Reason for the mode.
enum class PlanReason {
  kStart,       ///< a motion, or a goal that jumped: the choice comes first
  kArrives,     ///< the direct policy is predicted to arrive
  kQuicker,     ///< the chosen candidate is predicted to arrive first
  kFails,       ///< the direct policy is predicted to touch something, to stagnate or not to arrive
  kStagnates,   ///< it has stagnated
  kNoPath,      ///< nothing better was found
  kPathEnds,    ///< the path is at its end
  kNoProgress,  ///< the robot makes no progress along the path
  kPathBroken,  ///< an object is in the path's way
  kTraffic,     ///< the goal or something near moves
  kDirectWay,   ///< a direct way to the goal is free
  kBesideGoal,  ///< it stands within the goal's tolerances, but the motion does not end
};

constexpr auto words(Of<PlanReason>) {
  return std::to_array<std::string_view>({"start", "arrives", "quicker", "fails", "stagnates", "no_path", "path_ends",
                                          "no_progress", "path_broken", "traffic", "direct_way", "beside_goal"});
}

/// Kinds of candidates of a choice.
enum class PlanKind {
  kNone,    ///< there was no choice yet
  kPolicy,  ///< the direct policy goes on
  kDetour,  ///< a detour of the direct policy: in stores of simulation version 12 and before
  kPath     ///< a planned path
};

constexpr auto words(Of<PlanKind>) { return std::to_array<std::string_view>({"none", "policy", "detour", "path"}); }

/// Result of a choice: the quicker candidate, the policy if both are equal. Times run from its effect to the arrival at
/// the goal [s]; negative: the candidate does not arrive.
struct PlanVerdict {
  PlanKind kind = PlanKind::kNone;
  int tried = 0;          ///< number of candidates
  double policy = -1.0;   ///< time of the direct policy
  double by_path = -1.0;  ///< time of the path; negative also if the policy is quicker
};

/// The part of the look-ahead's state that samples carry. Poses of the base are (x, y, phi) in W, as measured.
struct PlanBrief {
  PlanMode mode = PlanMode::kDirect;
  PlanReason reason = PlanReason::kStart;
  bool going_on = false;             ///< the direct policy goes on while a choice is worked out
  int attempts = 0;                  ///< choices begun since reset()
  double clock = 0.0;                ///< time on the path [s]
  double duration = 0.0;             ///< duration of the path [s]; 0 without one
  double lag = 0.0;                  ///< lag behind the path [m]
  Vector3 target = Vector3::Zero();  ///< the path's base pose at `clock` [m, m, rad]; 0 without one
  Vector3 end = Vector3::Zero();     ///< the path's last base pose [m, m, rad]
  PlanVerdict choice;                ///< last choice
};

constexpr void describe(auto& v, Of<PlanVerdict>) {
  v.member("choice", &PlanVerdict::kind, {.text = "what the last choice fell on"});
  v.member("tried", &PlanVerdict::tried, in_range({0, 1e9}, "", "candidates of that choice"));
  v.member("time_policy", &PlanVerdict::policy,
           quantity("s", "predicted then, until the goal, of the policy as it was; negative: it does not arrive"));
  v.member("time_path", &PlanVerdict::by_path,
           quantity("s", "of a path; negative: none was found, or none that is quicker"));
}

constexpr void describe(auto& v, Of<PlanBrief>) {
  v.member("mode", &PlanBrief::mode, {.text = "what the robot is doing about its goal"});
  v.member("reason", &PlanBrief::reason, {.text = "and why"});
  v.member("going_on", &PlanBrief::going_on, {.text = "whether the policy goes on while a choice is worked out"});
  v.member("attempts", &PlanBrief::attempts, in_range({0, 1e9}, "", "choices begun since the start"));
  v.member("clock", &PlanBrief::clock, non_negative("s", "on the path"));
  v.member("duration", &PlanBrief::duration, non_negative("s", "of the path; 0 without one"));
  v.member("lag", &PlanBrief::lag, non_negative("m", "behind the path"));
  v.member("target", &PlanBrief::target,
           quantity("m, m, rad", "where the path has the base at `clock`: x, y and heading; 0 without one"));
  v.member("end", &PlanBrief::end, quantity("m, m, rad", "and where it ends"));
  v.inlined(&PlanBrief::choice);
}

static_assert(is_complete<PlanBrief>() && is_complete<PlanVerdict>());

}  // namespace moma
