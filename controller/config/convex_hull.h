#pragma once

#include <array>
#include <optional>
#include <vector>

#include "controller/model/shape.h"

namespace moma::config {

using Triangle3 = std::array<Vector3, 3>;

/// The corners of a triangle of indices.
Triangle3 corners(const std::vector<Vector3>& vertices, const Eigen::Vector3i& triangle);

/// True for points of no volume: thickness over length below 1e-7, or fewer than four.
bool in_one_plane(const std::vector<Vector3>& points);

/// Convex hull (Qhull, through coal), exact to rounding; its vertices are some of `points`, its faces look outwards.
/// None if the points lie in one plane, or if more than 255 faces meet in a vertex (the rim of a disc that is cut into
/// triangles from one point).
std::optional<ConvexHull> convex_hull(const std::vector<Vector3>& points);

/// True if the triangles are the closed surface of the hull of all vertices, seen counter-clockwise from outside, to a
/// millionth of its length; with 255 triangles at most at a vertex. Indices must be those of vertices.
bool is_hull(const ConvexHull& hull);

struct EnclosingHull {
  ConvexHull hull;
  std::vector<Vector3> chosen;
  ConvexHull inside;  ///< of the chosen points
};

/// Convex hull of at most `most_vertices` (8 to 255) vertices around all points, close to the exact one. Points are
/// chosen greedily, the furthest beyond a face first (the order of Quickhull, Barber et al., ACM TOMS 22(4), 1996).
/// Then the plane of each face moves out until all points are behind it, and each vertex moves by the shortest way
/// beyond the planes of its faces. Points that a call with fewer vertices has `chosen` need not be chosen again. Throws
/// std::runtime_error if the points have no hull. Cost: 96 vertices around 2,000 points take 30 ms.
EnclosingHull enclosing_hull(const std::vector<Vector3>& cloud, int most_vertices, std::vector<Vector3> chosen = {});

/// [m]
double distance_to_triangle(const Triangle3& triangle, const Vector3& p) noexcept;

/// Distances of points from a hull, which must outlive it, by its faces, which look outwards.
class DistanceOutside {
 public:
  explicit DistanceOutside(const ConvexHull& hull);
  /// Distance from p to the hull, 0 inside [m]; exact to 1e-9 of the hull's length.
  double of(const Vector3& p) const noexcept;

 private:
  const ConvexHull& hull_;
  double rounding_ = 0.0;
  std::vector<Vector3> normals_;
};

/// Largest distance of a point of `outer` from `inner` [m]: that of a vertex, since the distance is convex.
double excess(const ConvexHull& outer, const ConvexHull& inner);

}  // namespace moma::config
