#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>

#include "controller/lookahead/plan_brief.h"
#include "controller/plan/path.h"

namespace moma {

// Steps count control periods since the start or the goal's last jump.

/// The controller's own policy drives.
struct GoingDirect {};

/// The policy drives until step `commit`. Meanwhile a choice is worked out for the robot as it is predicted to be then.
struct GoingOn {
  std::int64_t commit = 0;
  double direct_time = -1.0;  ///< predicted time of the policy from then on [s]; negative: it fails
  bool chosen = false;        ///< the choice is made: the state's `path`
};

/// The robot follows the state's `path`.
struct Following {
  std::int64_t mark = 0;    ///< step of the last progress along the path ...
  double mark_clock = 0.0;  ///< ... and the path's clock then [s]
  bool former = false;      ///< the path leads to the goal before, and the next way is not known yet
};

/// The robot slows down, to choose at rest.
struct Stopping {
  std::int64_t stop_end = 0;  ///< step at which the choice begins even if the robot still moves
  double direct_time = -1.0;  ///< as in GoingOn
};

/// The robot stands and chooses.
struct Choosing {
  std::int64_t stop_end = 0;  ///< step at which it began
  double direct_time = -1.0;  ///< as in GoingOn
};

/// The robot stands and looks for a direct way.
struct SettingOut {};

/// One alternative for each PlanMode, in its order; GoingOn, which has the mode `direct` too, is the last.
using Doing = std::variant<GoingDirect, Following, Stopping, Choosing, SettingOut, GoingOn>;
inline constexpr std::size_t kGoingOn = std::variant_size_v<Doing> - 1;

/// Memory of the look-ahead. Together with the observation it determines the step. It does not contain work in progress
/// (a prediction or a choice), which begins again.
struct PlanState {
  PlanBrief brief;  ///< `mode` and `going_on` follow from `doing`
  Doing doing;
  std::int64_t steps = 0;        ///< since the start or the goal's last jump
  std::int64_t next = 0;         ///< step of the next prediction
  std::int64_t next_onward = 0;  ///< step of the next search for a path on from a goal that is passed
  int stagnations = 0;           ///< stagnations of the policy that are dealt with
  bool clears_detours = false;   ///< the next step clears the policy's memory of detours
  double rate = 0.0;             ///< of the path's clock in the step before; 0 without a path
  int known = 0;                 ///< number of visible objects in the step before
  bool has_goal = false;
  Isometry X_WG = Isometry::Identity();  ///< goal in the step before
  Path path;                             ///< without motions if there is none
  bool missed = false;                   ///< the goal was passed and not reached: it is stopped at
  int steps_beside = 0;                  ///< steps for which it has stood within the tolerances, though not at the goal
  bool left_last_part = false;           ///< the last part of a path to this goal was left to the policy
  bool held_off = false;                 ///< something held the robot off the end of a path to this goal
};

}  // namespace moma
