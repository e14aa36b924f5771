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

constexpr void describe(auto& v, Of<RoundTrip>) {
  v.member("periods", &RoundTrip::periods, non_negative("", "control periods that it takes"));
  v.member("misfit", &RoundTrip::misfit, {.text = "of 0, 1, 2 ... periods"});
}

/// Identifies the round trip: the age of the command that matches the measured velocity. The misfit of each age d
/// forgets exponentially, m_d += part (|v_measured - u_{k-1-d}|^2 - m_d). Another age replaces the present one if
/// m_best + floor < better (m_now + floor), with `floor` the contribution of noise: without motion the estimate stays.
/// Only the sum of drive and sensor latency is observable, not its parts.

/// Updates one age's misfit with this step's squared difference. `part`: control period / time constant.
inline void settle(RoundTrip& trip, int age, double squared, double part) noexcept {
  trip.misfit[age] += part * (squared - trip.misfit[age]);
}

/// Takes the age with the least misfit, if it is clearly better. True if the age changed.
inline bool choose(RoundTrip& trip, double floor, double better) noexcept {
  Eigen::Index best = 0;
  if (!(trip.misfit.minCoeff(&best) + floor < better * (trip.misfit[trip.periods] + floor))) return false;
  if (best == trip.periods) return false;
  trip.periods = static_cast<int>(best);
  return true;
}

}  // namespace moma
