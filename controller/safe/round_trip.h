#pragma once

#include "controller/describe/describe.h"
#include "controller/types.h"

namespace moma {

/// Round trip from a command to the measurement of its velocity, with the misfit of each candidate.
struct RoundTrip {
  int periods = 0;  ///< present estimate
  /// Misfit of each candidate of 0, 1, 2 ... periods: exponentially weighted mean of the squared difference [(m/s)^2,
  /// (rad/s)^2]. The base has one block of candidates per drive (Predictor).
  VectorX misfit;
};

constexpr void describe(auto& v, Of<RoundTrip>) {
  v.member("periods", &RoundTrip::periods, non_negative("", "control periods that it takes"));
  v.member("misfit", &RoundTrip::misfit, {.text = "of 0, 1, 2 ... periods; of the base, for each drive"});
}

/// Identifies the round trip: the age of the command that matches the measured velocity. The misfit of each candidate d
/// forgets exponentially, m_d += part (|v_measured - u_{k-1-d}|^2 - m_d). Another one replaces the present one if
/// m_best + floor < better (m_now + floor), with `floor` the contribution of noise: without motion the estimate stays.
/// Only the sum of drive and sensor latency is observable, not its parts.

/// Updates one candidate's misfit with this step's squared difference. `part`: control period / time constant.
inline void settle(VectorX& misfit, int candidate, double squared, double part) noexcept {
  misfit[candidate] += part * (squared - misfit[candidate]);
}

/// Returns the candidate with the least misfit if it is clearly better than the present one, else that.
inline int chosen(const Eigen::Ref<const VectorX>& misfit, int present, double floor, double better) noexcept {
  Eigen::Index best = 0;
  return misfit.minCoeff(&best) + floor < better * (misfit[present] + floor) ? static_cast<int>(best) : present;
}

}  // namespace moma
