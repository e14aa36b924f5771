#pragma once

#include <optional>

#include "controller/model/proximity.h"

namespace moma {

/// Signed distance of a point to a solid, and the unit gradient with respect to the point.
struct PointDistance {
  double d = 0.0;
  Vector3 n_S = Vector3::UnitZ();
};

/// Exact for sphere, box, cylinder and capsule, inside and outside; if the gradient is not unique (a centre, an axis),
/// one of the valid directions. A convex hull is replaced by its bounding sphere.
PointDistance point_distance(const Shape& shape, const Vector3& p_S) noexcept;
/// Returns d alone, to the same bit, in half the time.
double point_gap(const Shape& shape, const Vector3& p_S) noexcept;

/// Closed forms: sphere against sphere, box, cylinder and capsule; capsule against capsule, and against box and
/// cylinder while its axis is outside (capsule_distance). Unlike an iterative method they stay exact if axes cross or a
/// centre is inside. Empty for any other pair.
std::optional<Distance> analytic_distance(const Shape& first, const Isometry& X_W1, const Shape& second,
                                          const Isometry& X_W2) noexcept;

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
