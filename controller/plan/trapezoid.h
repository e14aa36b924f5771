#pragma once

#include <cmath>

namespace moma {

/// A motion to rest: speed rises evenly for `rise` seconds, stays, and falls evenly for `fall` seconds. Without a rise
/// it begins at its full speed.
struct Trapezoid {
  double time = 0.0;  ///< duration, at least rise + fall [s]
  double rise = 0.0;  ///< time of speeding up [s]
  double fall = 0.0;  ///< time of slowing down [s]

  /// Returns the full speed, in ways per second.
  double peak() const noexcept { return 1.0 / (time - 0.5 * (rise + fall)); }
  /// Returns the part of the way at time t: 0 before the start, 1 after the end.
  double part(double t) const noexcept {
    if (t <= 0.0) return time > 0.0 ? 0.0 : 1.0;
    if (t >= time) return 1.0;
    if (t < rise) return 0.5 * peak() / rise * t * t;
    if (t > time - fall) return 1.0 - 0.5 * peak() / fall * (time - t) * (time - t);
    return peak() * (t - 0.5 * rise);
  }

  /// Returns the same motion in `factor` >= 1 times the time.
  Trapezoid stretched(double factor) const noexcept { return {factor * time, factor * rise, factor * fall}; }
};

/// Returns the quickest trapezoid. A single way L with speed v and acceleration a has at_speed = L/v, square = L/a;
/// several ways at once have the largest of each. Peak speed is L/(T - r) and acceleration L/((T - r) r), so that T = r
/// + max(at_speed, square/r) is least at r = square/at_speed, or at r = sqrt(square) where the peak is not reached.
inline Trapezoid quickest(double at_speed, double square) noexcept {
  if (at_speed <= 0.0) return {};
  if (square <= 0.0) return {at_speed, 0.0, 0.0};
  const double root = std::sqrt(square);
  if (root >= at_speed) return {2.0 * root, root, root};
  return {at_speed + square / at_speed, square / at_speed, square / at_speed};
}

inline Trapezoid quickest_way(double length, double speed, double acceleration) noexcept {
  length = std::abs(length);
  return length < 1e-9 ? Trapezoid{} : quickest(length / speed, length / acceleration);
}

}  // namespace moma
