#pragma once

#include <array>
#include <limits>
#include <span>

#include "controller/plan/edge.h"

namespace moma {

/// A part of a path: `change` is added to the configuration between `start` and `start + time`, as a trapezoid.
struct PathPart {
  double start = 0.0;  ///< on the path's clock [s]
  double time = 0.0;   ///< [s]
  double ramp = 0.0;   ///< at either end [s]
  WholeConfiguration change;
};

/// A timed path of base and arm: motions that overlap a little, each from rest to rest. Everything that following it
/// needs, in a fixed size. Its axes are those of the world as it was seen when it was laid; `goal` says where the goal
/// was then.
struct Path {
  static constexpr int kMostMotions = 40;

  WholeConfiguration origin;
  std::array<PathPart, kMostMotions> motions;
  int count = 0;
  double duration = 0.0;   ///< [s]
  double clearance = 0.0;  ///< from objects at rest [m]; half of it where motions overlap
  /// And where E is at the goal, if that is less; it grows with the distance from there (goal_clearance.h) [m].
  double kept_at_goal = std::numeric_limits<double>::infinity();
  Isometry X_WG = Isometry::Identity();

  /// Where it is at t; its ends beyond them. Meaningless for a path without motions.
  void at(double t, WholeConfiguration& c) const noexcept;
};

/// Lays out edges as motions. Each begins up to `overlap` seconds before the one before it ends, by half of the shorter
/// one's time at most; of the same kind by a ramp, so that their speeds do not add up to more than the limits. False
/// where there are more motions than a path can hold.
bool lay_path(const MotionLimits& limits, std::span<const Edge> edges, double overlap, Path& path) noexcept;

}  // namespace moma
