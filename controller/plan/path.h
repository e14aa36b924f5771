#pragma once

#include <array>
#include <limits>
#include <span>

#include "controller/plan/edge.h"

namespace moma {

/// A motion of a path: it adds `change` to the configuration between `start` and `start + time`, as a trapezoid.
struct PathPart {
  double start = 0.0;  ///< time on the path's clock [s]
  double time = 0.0;   ///< [s]
  double ramp = 0.0;   ///< time of speeding up, and of slowing down [s]
  WholeConfiguration change;
};

/// A timed path of base and arm: overlapping motions, each from rest to rest, in a fixed size. Its axes are the world's
/// at the time of planning, when the goal was at X_WG.
struct Path {
  static constexpr int kMostMotions = 40;

  WholeConfiguration origin;
  std::array<PathPart, kMostMotions> motions;
  int count = 0;
  double duration = 0.0;   ///< [s]
  double clearance = 0.0;  ///< distance from objects at rest, half of it where motions overlap [m]
  /// Smaller distance at the goal; it grows with the distance from the goal (goal_clearance.h) [m].
  double kept_at_goal = std::numeric_limits<double>::infinity();
  Isometry X_WG = Isometry::Identity();

  /// Computes the configuration at time t, clamped to the path's ends. The path must have motions.
  void at(double t, WholeConfiguration& c) const noexcept;
};

/// Makes motions of edges. Each motion begins up to `overlap` seconds before the end of the one before it, at most half
/// of the shorter one's time. Motions of the same kind overlap by a ramp, so that their summed speeds keep the limits.
/// False if the path cannot hold all motions.
bool lay_path(const MotionLimits& limits, std::span<const Edge> edges, double overlap, Path& path) noexcept;

}  // namespace moma
