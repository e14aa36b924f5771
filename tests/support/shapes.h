#pragma once

#include <cmath>
#include <memory>
#include <random>

#include "controller/model/proximity.h"

namespace moma::test {

inline Shape make_sphere(double radius) { return {ShapeKind::kSphere, Vector3(radius, 0, 0), nullptr}; }
inline Shape make_box(double x, double y, double z) { return {ShapeKind::kBox, Vector3(x, y, z), nullptr}; }
inline Shape make_cylinder(double radius, double length) {
  return {ShapeKind::kCylinder, Vector3(radius, length, 0), nullptr};
}
inline Shape make_capsule(double radius, double length) {
  return {ShapeKind::kCapsule, Vector3(radius, length, 0), nullptr};
}

/// A convex polytope: an octahedron with half axes a, b, c about a point.
inline Shape make_octahedron(double a, double b, double c, const Vector3& centre = Vector3::Zero()) {
  auto hull = std::make_shared<ConvexHull>();
  hull->vertices = {{a, 0, 0}, {-a, 0, 0}, {0, b, 0}, {0, -b, 0}, {0, 0, c}, {0, 0, -c}};
  hull->triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (Vector3& v : hull->vertices) v += centre;
  return {ShapeKind::kConvex, Vector3::Zero(), hull};
}

inline Isometry placed(const Vector3& p, const Vector3& rotation_vector = Vector3::Zero()) {
  Isometry X = Isometry::Identity();
  const double angle = rotation_vector.norm();
  if (angle > 0.0) X.linear() = Eigen::AngleAxisd(angle, rotation_vector / angle).toRotationMatrix();
  X.translation() = p;
  return X;
}

inline Shape random_shape(ShapeKind kind, std::mt19937& engine) {
  const auto size = [&] { return std::uniform_real_distribution<>(0.05, 0.3)(engine); };
  switch (kind) {
    case ShapeKind::kSphere:
      return make_sphere(size());
    case ShapeKind::kBox:
      return make_box(size(), size(), size());
    case ShapeKind::kCylinder:
      return make_cylinder(size(), size());
    case ShapeKind::kCapsule:
      return make_capsule(size(), size());
    case ShapeKind::kConvex:
      break;
  }
  return make_octahedron(size(), size(), size(), Vector3(size(), -size(), 0.2));
}

inline Isometry random_pose(std::mt19937& engine, double spread) {
  std::uniform_real_distribution<> place(-spread, spread);
  std::normal_distribution<> normal;
  const Eigen::Quaterniond turn(normal(engine), normal(engine), normal(engine), normal(engine));
  Isometry X = Isometry::Identity();
  X.linear() = turn.normalized().toRotationMatrix();
  X.translation() = Vector3(place(engine), place(engine), place(engine));
  return X;
}

/// Largest x . direction over the solid, in world axes: a few lines per kind, independent of the distance code.
inline double support(const Shape& shape, const Isometry& X_WS, const Vector3& direction_W) {
  const Vector3 u = X_WS.linear().transpose() * direction_W;
  double value = 0.0;
  switch (shape.kind) {
    case ShapeKind::kSphere:
      value = shape.size.x() * u.norm();
      break;
    case ShapeKind::kBox:
      value = 0.5 * shape.size.dot(u.cwiseAbs());
      break;
    case ShapeKind::kCylinder:
      value = 0.5 * shape.size.y() * std::abs(u.z()) + shape.size.x() * std::hypot(u.x(), u.y());
      break;
    case ShapeKind::kCapsule:
      value = 0.5 * shape.size.y() * std::abs(u.z()) + shape.size.x() * u.norm();
      break;
    case ShapeKind::kConvex:
      value = -1e300;
      for (const Vector3& v : shape.hull->vertices) value = std::max(value, v.dot(u));
      break;
  }
  return value + X_WS.translation().dot(direction_W);
}

/// Width of the gap between two solids along the unit vector n (negative: overlap), n pointing from second to first.
inline double gap_along(const Shape& first, const Isometry& X_W1, const Shape& second, const Isometry& X_W2,
                        const Vector3& n) {
  return -support(first, X_W1, -n) - support(second, X_W2, n);
}

}  // namespace moma::test
