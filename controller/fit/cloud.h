#pragma once

#include <array>
#include <vector>

#include "controller/types.h"

namespace moma::fit {

using Points = std::vector<Vector3>;
using Triangle = std::array<Vector3, 3>;
using Triangles = std::vector<Triangle>;

/// Corners of all triangles.
Points corners(const Triangles& triangles);

/// What of the surface lies in low <= axis . x <= high: triangles cut at the two planes (Sutherland-Hodgman). A convex
/// solid that encloses the corners of the result encloses that part of the surface, and of the body inside it too:
/// every extreme point of the body's part is a corner.
Triangles clipped(const Triangles& triangles, const Vector3& axis, double low, double high);

/// Vertices of the convex hull of `points`; without repetitions only, where they lie in one plane.
Points hull_points(const Points& points);

/// The furthest of `points` in `count` directions spread evenly over the sphere (a Fibonacci spiral), each once. The
/// points themselves where they are no more than that.
Points extreme_points(const Points& points, int count);

/// `count` unit vectors spread evenly over the half sphere z >= 0.
std::vector<Vector3> half_sphere(int count);

/// Axes along which the points scatter most, in between and least (eigenvectors of their covariance): a rotation.
Matrix3 principal_axes(const Points& points);

}  // namespace moma::fit
