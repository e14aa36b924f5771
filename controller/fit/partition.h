#pragma once

#include <vector>

#include "controller/fit/best_solid.h"
#include "controller/fit/placed.h"

namespace moma::fit {

struct FitOptions {
  int max_shapes = 3;  ///< per link, >= 1
  Kinds kinds;
};

/// Factor by which a further shape must reduce the union (weighted by kind, see weight()).
inline constexpr double kGain = 1.1;

/// Returns shapes that together enclose the surfaces of a link and the bodies inside them. The whole is cut by planes
/// across the axes of its box and of the link, into two or three slabs (comparing all choices among twelve positions
/// with quick fits), and the parts are cut again while more shapes are allowed. Each part is the surface clipped
/// between its planes, enclosed by one shape. Several surfaces are also fitted one by one. Among the numbers of shapes,
/// the least volume of the union times kGain per further shape wins. Deterministic. At least one surface, each of at
/// least one triangle. About 0.3 s for three shapes.
std::vector<Placed> fit_surfaces(const std::vector<Triangles>& surfaces, const FitOptions& options);

}  // namespace moma::fit
