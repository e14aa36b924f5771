#pragma once

#include <vector>

#include "controller/fit/enclosing.h"
#include "controller/fit/placed.h"

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

struct FitOptions {
  int max_shapes = 3;  ///< per link, >= 1
  Kinds kinds;
};

/// One more shape has to make the union smaller by this factor (weighted by kind, see weight()).
inline constexpr double kGain = 1.1;

/// Shapes that together enclose the surfaces of a link, and the bodies inside them. All of it is cut by planes across
/// the axes of its box and those of the link, in two or three slabs (all choices of twelve places are compared, with
/// quick fits), then the parts again where more shapes are allowed; each part is the surface clipped between its
/// planes, and one shape encloses all of it. Several surfaces are also tried one by one. Of the numbers of shapes
/// tried, the one with the least volume of the union times kGain per further shape is taken. Deterministic. At least
/// one surface, each of at least one triangle. About 0.3 s for three shapes.
std::vector<Placed> fit_surfaces(const std::vector<Triangles>& surfaces, const FitOptions& options);

}  // namespace moma::fit
