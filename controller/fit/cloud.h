#pragma once

#include <array>
#include <vector>

#include "controller/types.h"

namespace moma::fit {

using Points = std::vector<Vector3>;
using Triangle = std::array<Vector3, 3>;
using Triangles = std::vector<Triangle>;

Points corners(const Triangles& triangles);

Triangles together(const std::vector<Triangles>& surfaces);

/// Returns the part of the surface in low <= axis . x <= high: triangles cut at the two planes (Sutherland-Hodgman). A
/// convex solid around its corners also encloses that part of the body inside: every extreme point is a corner.
Triangles clipped(const Triangles& triangles, const Vector3& axis, double low, double high);

/// Returns the vertices of the convex hull of `points`; if they are coplanar, the points without repetitions.
Points hull_points(const Points& points);

/// Returns the furthest of `points` in each of `count` directions spread evenly over the sphere (a Fibonacci spiral).
Points extreme_points(const Points& points, int count);

/// Returns `count` unit vectors spread evenly over the half sphere z >= 0.
std::vector<Vector3> half_sphere(int count);

/// Returns the principal axes of the points, by decreasing scatter (eigenvectors of their covariance), as a rotation.
Matrix3 principal_axes(const Points& points);

}  // namespace moma::fit
