#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "controller/model/shape.h"

namespace moma::test {

/// Fixed axes x, y, z, written out.
inline Matrix3 rotation_of(const Vector3& rpy) {
  const double cr = std::cos(rpy.x()), sr = std::sin(rpy.x());
  const double cp = std::cos(rpy.y()), sp = std::sin(rpy.y());
  const double cy = std::cos(rpy.z()), sy = std::sin(rpy.z());
  Matrix3 R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  return R;
}

/// How far a point lies outside a sphere, capsule or box, 0 inside; by the ends of a capsule's axis and the faces of a
/// box. Infinite for any other kind.
inline double outside(const Shape& shape, const Vector3& place, const Matrix3& R, const Vector3& p) {
  const Vector3& s = shape.size;
  if (shape.kind == ShapeKind::kSphere) return std::max(0.0, (p - place).norm() - s.x());
  if (shape.kind == ShapeKind::kCapsule) {
    const Vector3 a = place - 0.5 * s.y() * R.col(2);
    const Vector3 ab = s.y() * R.col(2);
    const double t = std::clamp((p - a).dot(ab) / ab.dot(ab), 0.0, 1.0);
    return std::max(0.0, (p - a - t * ab).norm() - s.x());
  }
  if (shape.kind != ShapeKind::kBox) return std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (int i = 0; i < 3; ++i) most = std::max(most, std::abs(R.col(i).dot(p - place)) - 0.5 * s[i]);
  return most;
}

/// The triangle's corners and points of it at most about `spacing` apart.
inline std::vector<Vector3> points_on(const Vector3& a, const Vector3& b, const Vector3& c, double spacing) {
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  const int n = std::clamp(static_cast<int>(std::ceil(longest / spacing)), 1, 200);
  std::vector<Vector3> points;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) points.push_back(a + (b - a) * i / n + (c - a) * j / n);
  return points;
}

}  // namespace moma::test
