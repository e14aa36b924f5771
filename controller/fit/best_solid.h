#pragma once

#include "controller/fit/enclosing.h"

namespace moma::fit {

/// What a kind's volume counts for when kinds are compared: a simpler or rounder shape wins where it is hardly larger.
/// A box has flat sides, whose nearest point jumps when something turns before them, and its distances to other boxes
/// are found by iteration.
inline constexpr double kCapsuleWeight = 1.02;
inline constexpr double kBoxWeight = 1.15;

/// Of boxes on a base that drives and turns: their corners sweep, and their sides are traps for a reactive controller.
inline constexpr double kBaseBoxWeight = 1.6;

/// Kinds that a fit may use; at least one.
struct Kinds {
  bool sphere = true;
  bool capsule = true;
  bool box = true;
  double box_weight = kBoxWeight;
};

/// 1 for a sphere.
double weight(ShapeKind kind, const Kinds& kinds) noexcept;

/// The kind with the least weighted volume around all `points` (at least one).
Solid best_solid(const Points& points, const Kinds& kinds, Effort effort);

}  // namespace moma::fit
