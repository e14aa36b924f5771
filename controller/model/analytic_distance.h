#pragma once

#include <optional>

#include "controller/model/proximity.h"

namespace moma {

/// Signed distance of a point to a solid, and the unit gradient with respect to the point.
struct PointDistance {
  double d = 0.0;
  Vector3 n_S = Vector3::UnitZ();
};

/// Exact for sphere, box, cylinder and capsule, inside as outside; where the gradient is not unique (a centre, an
/// axis) one of the right directions is chosen. A convex hull is not handled: its bounding sphere is used instead.
PointDistance point_distance(const Shape& shape, const Vector3& p_S) noexcept;
/// Its d alone, to the same bit, for half the time.
double point_gap(const Shape& shape, const Vector3& p_S) noexcept;

/// Closed forms: sphere against sphere, box, cylinder and capsule; capsule against capsule, and against box and
/// cylinder while its axis lies outside (segment_distance.h). Unlike an iterative method they stay exact where axes
/// cross and where a centre lies inside. Empty for any other pair.
std::optional<Distance> analytic_distance(const Shape& first, const Isometry& X_W1, const Shape& second,
                                          const Isometry& X_W2) noexcept;

}  // namespace moma
