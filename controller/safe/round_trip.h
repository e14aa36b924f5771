#pragma once

#include "controller/describe/describe.h"
#include "controller/types.h"

namespace moma {

/// How long it takes from a command until the velocity that it leads to is measured, and how well each time that was
/// thought of explains what is measured.
struct RoundTrip {
  int periods = 0;  ///< taken to be
  VectorX misfit;   ///< of 0, 1, 2 ... periods: mean squared difference over the last half second [(m/s)^2, (rad/s)^2]
};

template <class V>
constexpr void describe(V& v, Of<RoundTrip>) {
  v.member("periods", &RoundTrip::periods, {.range = Range::non_negative(), .text = "control periods that it takes"});
  v.member("misfit", &RoundTrip::misfit, {.text = "of 0, 1, 2 ... periods"});
}

/// Finds the time from command to measured velocity: the command of which age it is, its changes tell. The misfit of
/// each age d forgets exponentially, m_d += (T/0.5 s)(|v_measured - u_{k-1-d}|^2 - m_d); another age is taken where
/// m_best + floor < 0.7 (m_now + floor), `floor` being what noise leaves of each: without motion nothing is taken.
/// Only the sum of a drive's and a sensor's lateness can be seen so, not its parts.

/// One age's misfit, with the squared difference that it has at this step. `dt` [s].
void settle(RoundTrip& trip, int age, double squared, double dt) noexcept;

/// Takes the age that explains the motion best, if it is clearly better. True where it is another one than before.
bool choose(RoundTrip& trip, double floor) noexcept;

}  // namespace moma
