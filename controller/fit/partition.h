#pragma once

#include <vector>

#include "controller/fit/enclosing.h"
#include "controller/fit/placed.h"

namespace moma::fit {

/// Weight of a kind's volume when kinds are compared. The nearest point of a box's flat side jumps when something turns
/// before it, and distances between boxes need iterations.
inline constexpr double kCapsuleWeight = 1.02;
inline constexpr double kBoxWeight = 1.15;

/// Weight of boxes on a mobile base: their corners sweep, and their sides trap a reactive controller.
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

/// Factor by which a further shape must reduce the union (weighted by kind, see weight()).
inline constexpr double kGain = 1.1;

/// Returns shapes that together enclose the surfaces of a link and the bodies inside them. Planes across the axes of
/// its box and of the link cut the whole into two or three slabs (quick fits compare all choices among twelve
/// positions), and the parts again while more shapes are allowed. One shape encloses each part. Several surfaces are
/// also fitted one by one. The least volume of the union times kGain per further shape wins. Deterministic. At least
/// one surface, each of at least one triangle. About 0.3 s for three shapes.
std::vector<Placed> fit_surfaces(const std::vector<Triangles>& surfaces, const FitOptions& options);

}  // namespace moma::fit
