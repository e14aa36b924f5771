#pragma once

#include <algorithm>
#include <memory>

#include "controller/model/analytic_distance.h"
#include "controller/model/proximity.h"

namespace coal {
class ShapeBase;
}

namespace moma {

/// A shape in coal's form; a convex hull is copied.
using ConvexGeometry = std::shared_ptr<const coal::ShapeBase>;
ConvexGeometry convex_geometry(const Shape& shape);

/// Signed distance of any two convex solids by coal's GJK and EPA. Owns their buffers: one per worker. Errors on random
/// pairs: below 1e-6 m apart, 2e-6 m in contact (2e-5 m for two cylinders).
class ConvexDistance {
 public:
  /// `max_vertices`: of the largest hull in use, so that no buffer grows.
  explicit ConvexDistance(int max_vertices);
  ~ConvexDistance();
  ConvexDistance(ConvexDistance&&) noexcept;
  ConvexDistance& operator=(ConvexDistance&&) noexcept;

  /// Does not allocate. Every call starts from the same guess, so that results do not depend on earlier calls.
  Distance distance(const ConvexGeometry& first, const Isometry& X_W1, const ConvexGeometry& second,
                    const Isometry& X_W2) noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A solid with precomputed quantities for distances.
struct Solid {
  Shape shape;
  double radius = 0.0;                     ///< of the bounding ball about the shape's origin [m]
  Shape bound;                             ///< the shape itself, or the bounding box of a convex hull
  Vector3 bound_offset = Vector3::Zero();  ///< centre of that box
  ConvexGeometry geometry;

  explicit Solid(const Shape& of) : shape(of), radius(bounding_radius(of)), bound(of), geometry(convex_geometry(of)) {
    if (of.kind != ShapeKind::kConvex || !of.hull || of.hull->vertices.empty()) return;
    Eigen::AlignedBox3d box;
    for (const Vector3& v : of.hull->vertices) box.extend(v);
    bound = {ShapeKind::kBox, box.sizes(), nullptr};
    bound_offset = box.center();
  }

  /// Lower bound of the distance of the solid's points to p_W.
  double gap(const Isometry& X_WS, const Vector3& p_W) const noexcept {
    const Vector3 p_S = X_WS.linear().transpose() * (p_W - X_WS.translation());
    return point_gap(bound, p_S - bound_offset);
  }
};

/// Gives a solid that is a box other edge lengths. Does not allocate.
void resize_box(Solid& solid, const Vector3& size) noexcept;

/// True if two placed solids are more than `range` apart by their bounding balls, or by one of them and the other's
/// ball; also if a pose is not finite. False if they may be nearer.
inline bool apart(const Solid& a, const Isometry& X_Wa, const Solid& b, const Isometry& X_Wb, double range) noexcept {
  const Vector3 ca = X_Wa.translation();
  const Vector3 cb = X_Wb.translation();
  const double reach = range + a.radius + b.radius;
  return !((ca - cb).squaredNorm() <= reach * reach) || !(a.gap(X_Wa, cb) - b.radius <= range) ||
         !(b.gap(X_Wb, ca) - a.radius <= range);
}

/// Lower bound of the signed distance, the greatest of the bounds of apart().
inline double least_gap(const Solid& a, const Isometry& X_Wa, const Solid& b, const Isometry& X_Wb) noexcept {
  const Vector3 ca = X_Wa.translation();
  const Vector3 cb = X_Wb.translation();
  return std::max({(ca - cb).norm() - a.radius - b.radius, a.gap(X_Wa, cb) - b.radius, b.gap(X_Wb, ca) - a.radius});
}

/// Computes the distance by a closed form if there is one, else by `convex`.
inline Distance signed_distance(const Solid& a, const Isometry& X_Wa, const Solid& b, const Isometry& X_Wb,
                                ConvexDistance& convex) noexcept {
  const auto exact = analytic_distance(a.shape, X_Wa, b.shape, X_Wb);
  return exact ? *exact : convex.distance(a.geometry, X_Wa, b.geometry, X_Wb);
}

}  // namespace moma
