#pragma once

#include <optional>
#include <vector>

#include "controller/fit/placed.h"

namespace moma::fit {

/// How well shapes enclose a surface. Overshoot is the distance from points spread evenly over the shapes' outer
/// surface to the convex hull of the enclosed surface; 0 for points inside the hull. Where the surface is hollow,
/// several shapes can be smaller than its hull.
struct FitError {
  std::optional<double> volume_ratio;  ///< of the union to the hull; empty where the hull is flat
  double mean_overshoot = 0.0;         ///< [m]
  double most_overshoot = 0.0;         ///< [m]
  double uncovered = 0.0;              ///< [m] furthest that a corner lies outside all shapes
};

/// Measured on about 2,000 points.
FitError measure(const Triangles& surface, const std::vector<Placed>& shapes);

}  // namespace moma::fit
