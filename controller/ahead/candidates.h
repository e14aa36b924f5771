#pragma once

#include "controller/escape_state.h"
#include "controller/model/kinematics.h"
#include "controller/params.h"
#include "controller/step.h"

namespace moma {

/// States of the direct policy's memory that are worth a prediction each: the vortex the one way round and the other,
/// stagnation at once (so that a detour begins, around the obstacles where there is such a way), and detours of half a
/// metre and more in directions all around the goal's.
inline constexpr int kCandidates = 17;

inline constexpr int kVortices = 2;     ///< the first of them
inline constexpr int kFirstDetour = 3;  ///< the one between stagnates

/// A detour's target: `length` [m] from the base (of a fixed one, from the first link), `angle` [rad] to the left of
/// the direction from E to the goal.
struct Detour {
  double angle = 0.0;
  double length = 0.0;
};
/// Of the candidate `index`, kFirstDetour or more.
Detour detour_of(int index) noexcept;

/// The `index`-th of them for a robot placed by `kinematics`.
EscapeState candidate(const EscapeParams& params, const Kinematics& kinematics, const GoalState& goal,
                      int index) noexcept;

}  // namespace moma
