#pragma once

#include "controller/fit/enclosing.h"

namespace moma::fit {

/// Factors on the volumes of kinds in their comparison: a simpler or rounder shape wins if it is hardly larger. A box
/// has flat sides, whose nearest point jumps when another solid turns before them, and its distances to other boxes
/// need iteration.
inline constexpr double kCapsuleWeight = 1.02;
inline constexpr double kBoxWeight = 1.15;

/// Factor on boxes of a base that drives and turns: their corners sweep, and their sides trap a reactive controller.
inline constexpr double kBaseBoxWeight = 1.6;

/// Kinds of shapes that a fit may use; at least one.
struct Kinds {
  bool sphere = true;
  bool capsule = true;
  bool box = true;
  double box_weight = kBoxWeight;
};

/// 1 for a sphere.
double weight(ShapeKind kind, const Kinds& kinds) noexcept;

/// Returns the kind with the least weighted volume around all `points` (at least one).
Solid best_solid(const Points& points, const Kinds& kinds, Effort effort);

}  // namespace moma::fit
