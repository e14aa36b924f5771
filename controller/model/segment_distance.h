#pragma once

#include <optional>

#include "controller/model/analytic_distance.h"

namespace moma {

/// Distance between a capsule and a box or cylinder, exact to rounding, while the capsule's axis lies outside the
/// solid; empty where it does not (deep contact), and for other solids.
///
/// The distance to a convex solid is a convex function of the point, so along the axis its derivative n . axis grows:
/// the nearest point is where it changes sign, found by regula falsi (Illinois) with bisection steps, about ten
/// evaluations. An iterative method for general solids stops at a gap of 1e-6 m, which leaves 1e-3 rad in the
/// direction. Where the axis runs along a face the middle of the axis is taken if all of it does.
std::optional<Distance> capsule_distance(const Shape& capsule, const Isometry& X_W1, const Shape& solid,
                                         const Isometry& X_W2) noexcept;

}  // namespace moma
