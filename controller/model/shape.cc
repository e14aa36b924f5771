#include "controller/model/shape.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace moma {
namespace {

constexpr double kTiny = 1e-9;

double sign(double value) noexcept { return value < 0.0 ? -1.0 : 1.0; }

}  // namespace

int num_sizes(ShapeKind kind) noexcept {
  static constexpr int kSizes[] = {1, 3, 2, 2, 0};
  static_assert(std::size(kSizes) == words(Of<ShapeKind>{}).size());
  return kSizes[static_cast<std::size_t>(kind)];
}

double bounding_radius(const Shape& shape) noexcept {
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return shape.size.x();
    case ShapeKind::kBox:
      return 0.5 * shape.size.norm();
    case ShapeKind::kCylinder:
      return std::hypot(shape.size.x(), 0.5 * shape.size.y());
    case ShapeKind::kCapsule:
      return shape.size.x() + 0.5 * shape.size.y();
    case ShapeKind::kConvex:
      break;
  }
  double squared = 0.0;
  if (shape.hull)
    for (const Vector3& v : shape.hull->vertices) squared = std::max(squared, v.squaredNorm());
  return std::sqrt(squared);
}

Vector3 support_point(const Shape& shape, const Isometry& X_WS, const Vector3& n_W) noexcept {
  const auto axis = [&](int i) -> Vector3 { return X_WS.linear().col(i); };
  Vector3 p = X_WS.translation();
  switch (shape.kind) {
    case ShapeKind::kSphere:
      p += shape.size.x() * n_W;
      break;
    case ShapeKind::kCapsule:
      p += shape.size.x() * n_W + 0.5 * shape.size.y() * sign(axis(2).dot(n_W)) * axis(2);
      break;
    case ShapeKind::kCylinder: {
      const double along = axis(2).dot(n_W);
      const Vector3 across = n_W - along * axis(2);
      const double length = across.norm();
      p += 0.5 * shape.size.y() * sign(along) * axis(2);
      if (length > kTiny) p += shape.size.x() / length * across;
      break;
    }
    case ShapeKind::kBox:
      for (int i = 0; i < 3; ++i) p += 0.5 * shape.size[i] * sign(axis(i).dot(n_W)) * axis(i);
      break;
    case ShapeKind::kConvex: {
      if (!shape.hull || shape.hull->vertices.empty()) break;
      const Vector3 n_S = X_WS.linear().transpose() * n_W;
      const auto furthest =
          std::max_element(shape.hull->vertices.begin(), shape.hull->vertices.end(),
                           [&](const Vector3& a, const Vector3& b) { return a.dot(n_S) < b.dot(n_S); });
      p += X_WS.linear() * *furthest;
      break;
    }
  }
  return p;
}

double extent_along(const Shape& shape, const Isometry& X_WS, const Vector3& n_W) noexcept {
  return n_W.dot(support_point(shape, X_WS, n_W));
}

double lowest_point(const Shape& shape, const Isometry& X_WS, Vector3* p_W) noexcept {
  const Matrix3 R = X_WS.linear();
  Vector3 p = X_WS.translation();
  const Vector3 axis = R.col(2);
  switch (shape.kind) {
    case ShapeKind::kSphere:
      p.z() -= shape.size.x();
      break;
    case ShapeKind::kBox:
      for (int i = 0; i < 3; ++i) p -= std::copysign(0.5 * shape.size[i], R(2, i)) * R.col(i);
      break;
    case ShapeKind::kCylinder: {
      p -= std::copysign(0.5 * shape.size.y(), axis.z()) * axis;
      // Steepest direction within the end disc; a horizontal disc is lowest everywhere.
      const Vector3 down = -Vector3::UnitZ() + axis.z() * axis;
      const double steep = down.norm();
      if (steep > 1e-12) p += shape.size.x() / steep * down;
      break;
    }
    case ShapeKind::kCapsule:
      p -= std::copysign(0.5 * shape.size.y(), axis.z()) * axis;
      p.z() -= shape.size.x();
      break;
    case ShapeKind::kConvex: {
      if (!shape.hull || shape.hull->vertices.empty()) break;
      const Vector3 row = R.row(2);
      const Vector3* lowest = &shape.hull->vertices.front();
      double least = row.dot(*lowest);
      for (const Vector3& v : shape.hull->vertices) {
        const double z = row.dot(v);
        if (z < least) {
          least = z;
          lowest = &v;
        }
      }
      p = X_WS * *lowest;
      break;
    }
  }
  if (p_W != nullptr) *p_W = p;
  return p.z();
}

}  // namespace moma
