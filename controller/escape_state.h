#pragma once

#include "controller/describe/complete.h"
#include "controller/describe/describe.h"
#include "controller/types.h"

namespace moma {

/// Memory of detours between steps (task/escape.h). Times count control periods, never a clock.
struct EscapeState {
  double best = -1.0;  ///< V at the last progress [m]; negative: no step yet
  double idle = 0.0;   ///< time since the last progress [s]
  int stagnations = 0;
  int side = 0;            ///< first side of detours, +1 or -1; 0 before the first stagnation
  bool detour = false;     ///< on a detour
  double remaining = 0.0;  ///< remaining time of the detour [s]
  Vector3 target_W = Vector3::Zero();
};

/// Form in traces, `moma solve` and case files (`state.escape`).
constexpr void describe(auto& v, Of<EscapeState>) {
  using T = EscapeState;
  v.member("best", &T::best, quantity("m", "V at its last progress; negative: no step taken yet"));
  v.member("idle", &T::idle, non_negative("s", "time without progress since"));
  v.member("stagnations", &T::stagnations, in_range({0, 1e9}, "", "how many there were"));
  v.member("side", &T::side, in_range({-1, 1}, "", "where detours turn first; 0: not chosen"));
  v.member("detour", &T::detour, {.text = "whether it is on one"});
  v.member("remaining", &T::remaining, quantity("s", "of the detour"));
  v.member("target", &T::target_W, quantity("m", "of the detour"));
}

static_assert(is_complete<EscapeState>());

}  // namespace moma
