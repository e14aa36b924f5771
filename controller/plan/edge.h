#pragma once

#include <cmath>

#include "controller/plan/configuration.h"

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

/// A piece of a path from a to b, from rest to rest. A differential base turns, drives straight (forwards or
/// backwards, whichever turns less) and turns; an omnidirectional base moves straight and turns evenly; a fixed base
/// stays. The arm moves straight in joint space. The slower of base and arm determines the time of both.
struct Edge {
  WholeConfiguration a, b;
  double turn1 = 0.0, turn2 = 0.0;  ///< turns of the base [rad]; an omnidirectional base has turn1 only
  double drive = 0.0;               ///< way of the base; negative: a differential base drives backwards [m]
  Trapezoid first, middle, last;    ///< quickest motions of the base; an omnidirectional base has `middle` only
  Trapezoid arm;                    ///< quickest motion of the arm
  double time = 0.0;                ///< time of the edge [s]

  double base_time() const noexcept { return first.time + middle.time + last.time; }
};

void make_edge(const MotionLimits& limits, const WholeConfiguration& a, const WholeConfiguration& b,
               Edge& edge) noexcept;

/// Computes the configuration at time t, clamped to [0, time].
void edge_at(const MotionLimits& limits, const Edge& edge, double t, WholeConfiguration& c) noexcept;

/// Computes the configuration at `part` in [0, 1] of the arm's way if the base is fixed, otherwise of the time.
void edge_point(const MotionLimits& limits, const Edge& edge, double part, WholeConfiguration& c) noexcept;

/// Returns the approximate travel of the robot's farthest point on the edge [m].
double longest_way(const MotionLimits& limits, const Edge& edge) noexcept;

/// Returns the time of the edge from a to b without making it [s].
double edge_time(const MotionLimits& limits, const WholeConfiguration& a, const WholeConfiguration& b) noexcept;

/// Sets b's heading to that in which a differential base drives there from a, forwards or backwards, whichever is
/// nearer to b's heading. It stays if a and b are at most `near` apart [m].
void head_along(const MotionLimits& limits, const WholeConfiguration& a, double near, WholeConfiguration& b) noexcept;

}  // namespace moma
