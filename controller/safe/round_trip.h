#pragma once

#include "controller/describe/describe.h"
#include "controller/types.h"

namespace moma {

/// Round trip from a command to the measurement of its velocity, with the misfit of each candidate.
struct RoundTrip {
  int periods = 0;  ///< present estimate
  /// Misfit of 0, 1, 2 ... periods: mean squared difference of late [(m/s)^2, (rad/s)^2].
  VectorX misfit;
};

template <class V>
constexpr void describe(V& v, Of<RoundTrip>) {
  v.member("periods", &RoundTrip::periods, non_negative("", "control periods that it takes"));
  v.member("misfit", &RoundTrip::misfit, {.text = "of 0, 1, 2 ... periods"});
}

/// Identifies the round trip: the age of the command that matches the measured velocity. The misfit of each age d
/// forgets exponentially, m_d += part (|v_measured - u_{k-1-d}|^2 - m_d). Another age replaces the present one if
/// m_best + floor < better (m_now + floor), with `floor` the contribution of noise: without motion the estimate stays.
/// Only the sum of drive and sensor latency is observable, not its parts.

/// Updates one age's misfit with this step's squared difference. `part`: control period / time constant.
void settle(RoundTrip& trip, int age, double squared, double part) noexcept;

/// Takes the age with the least misfit, if it is clearly better. True if the age changed.
bool choose(RoundTrip& trip, double floor, double better) noexcept;

}  // namespace moma
