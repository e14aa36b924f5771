#pragma once

#include <optional>

#include "controller/model/analytic_distance.h"

namespace moma {

/// Distance between a capsule and a box or cylinder, exact up to rounding, while the capsule's axis is outside the
/// solid; empty otherwise (deep contact), and for other solids.
///
/// The distance to a convex solid is a convex function of the point, so that its derivative n . axis increases along
/// the axis. The nearest point is its zero, found by regula falsi (Illinois) with bisection steps in about ten
/// evaluations. A general iterative method stops at a gap of 1e-6 m, which leaves 1e-3 rad in the direction. If the
/// whole axis runs along a face, its middle is taken.
std::optional<Distance> capsule_distance(const Shape& capsule, const Isometry& X_W1, const Shape& solid,
                                         const Isometry& X_W2) noexcept;

}  // namespace moma
