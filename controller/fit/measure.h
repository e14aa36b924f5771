#pragma once

#include <optional>
#include <vector>

#include "controller/fit/placed.h"

namespace moma::fit {

/// Error of shapes around a surface. Overshoot is the distance from points spread evenly over the shapes' outer surface
/// to the convex hull of the enclosed surface; 0 for points inside the hull. Several shapes around a hollow surface can
/// be smaller than its hull.
struct FitError {
  std::optional<double> volume_ratio;  ///< volume of the union over that of the hull; empty if the hull is flat
  double mean_overshoot = 0.0;         ///< [m]
  double most_overshoot = 0.0;         ///< [m]
  double uncovered = 0.0;              ///< largest distance of a corner outside all shapes [m]
};

/// Measures about 2,000 points.
FitError measure(const Triangles& surface, const std::vector<Placed>& shapes);

}  // namespace moma::fit
