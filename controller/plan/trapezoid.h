#pragma once

#include <algorithm>
#include <cmath>

namespace moma {

/// A motion from rest to rest: speed rises evenly for `ramp` seconds, stays, and falls for as long.
struct Trapezoid {
  double time = 0.0;  ///< of the whole [s]
  double ramp = 0.0;  ///< at most half of it [s]

  /// Part of the way that is done at t: 0 up to 0, 1 from `time` on.
  double part(double t) const noexcept {
    if (t <= 0.0) return time > 0.0 ? 0.0 : 1.0;
    if (t >= time) return 1.0;
    const double peak = 1.0 / (time - ramp);
    if (t < ramp) return 0.5 * peak / ramp * t * t;
    if (t > time - ramp) return 1.0 - 0.5 * peak / ramp * (time - t) * (time - t);
    return peak * (t - 0.5 * ramp);
  }

  /// The same, slower: `factor` >= 1 times as long.
  Trapezoid stretched(double factor) const noexcept { return {factor * time, factor * ramp}; }
};

/// The quickest one. For a single way L with speed v and acceleration a: at_speed = L/v, square = L/a; for several at
/// once, the largest of each. Peak speed is L/(T - r) and acceleration L/((T - r) r), so that T = r + max(at_speed,
/// square/r) is least at r = square/at_speed, or at r = sqrt(square) where the peak is not reached.
inline Trapezoid quickest(double at_speed, double square) noexcept {
  if (at_speed <= 0.0) return {};
  if (square <= 0.0) return {at_speed, 0.0};
  const double root = std::sqrt(square);
  if (root >= at_speed) return {2.0 * root, root};
  return {at_speed + square / at_speed, square / at_speed};
}

inline Trapezoid quickest_way(double length, double speed, double acceleration) noexcept {
  length = std::abs(length);
  return length < 1e-9 ? Trapezoid{} : quickest(length / speed, length / acceleration);
}

}  // namespace moma
