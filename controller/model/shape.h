#pragma once

#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "controller/describe/enumeration.h"
#include "controller/types.h"

namespace moma {

enum class ShapeKind { kSphere, kBox, kCylinder, kCapsule, kConvex };
constexpr auto words(Of<ShapeKind>) {
  return std::to_array<std::string_view>({"sphere", "box", "cylinder", "capsule", "convex"});
}

/// Convex hull of a mesh: its vertices in the shape's frame and the triangles of its surface (indices into `vertices`,
/// counter-clockwise seen from outside). Shared because hulls are large.
struct ConvexHull {
  std::vector<Vector3> vertices;
  std::vector<Eigen::Vector3i> triangles;
};

/// A solid about the origin of its own frame S. size [m]: sphere (radius, 0, 0); box full edge lengths; cylinder and
/// capsule (radius, length, 0) with the axis along z and a capsule's length without its caps; convex (0, 0, 0), with
/// `hull` instead.
struct Shape {
  ShapeKind kind = ShapeKind::kSphere;
  Vector3 size = Vector3::Zero();
  std::shared_ptr<const ConvexHull> hull;
};

/// Number of values in `size` of a shape of this kind: 1, 3, 2, 2 and 0.
int num_sizes(ShapeKind kind) noexcept;

/// Radius about the shape's origin of a sphere that encloses it [m].
double bounding_radius(const Shape& shape) noexcept;

/// The shape's furthest point along the unit vector n, exact for every kind; one of them if there are several.
Vector3 support_point(const Shape& shape, const Isometry& X_WS, const Vector3& n_W) noexcept;

/// Extent of the shape along n_W from the world's origin: n_W . support_point() [m].
double extent_along(const Shape& shape, const Isometry& X_WS, const Vector3& n_W) noexcept;

/// Smallest z of the shape at X_WS, exact for every kind [m]. For floor rows and clearances.
double lowest_point(const Shape& shape, const Isometry& X_WS, Vector3* p_W = nullptr) noexcept;

}  // namespace moma
