#include "controller/fit/cloud.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "controller/config/convex_hull.h"

namespace moma::fit {
namespace {

// The half of a polygon with sign * (axis . x - at) >= 0.
Points cut(const Points& polygon, const Vector3& axis, double at, double sign) {
  Points kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3& a = polygon[i];
    const Vector3& b = polygon[(i + 1) % polygon.size()];
    const double from = sign * (axis.dot(a) - at);
    const double to = sign * (axis.dot(b) - at);
    if (from >= 0.0) kept.push_back(a);
    if ((from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0)) kept.push_back(a + from / (from - to) * (b - a));
  }
  return kept;
}

Vector3 spiral(double z, int k) {
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
  return {r * std::cos(golden * k), r * std::sin(golden * k), z};
}

}  // namespace

Points corners(const Triangles& triangles) {
  Points points;
  for (const Triangle& t : triangles) points.insert(points.end(), t.begin(), t.end());
  return points;
}

Triangles together(const std::vector<Triangles>& surfaces) {
  Triangles all;
  for (const Triangles& surface : surfaces) all.insert(all.end(), surface.begin(), surface.end());
  return all;
}

Triangles clipped(const Triangles& triangles, const Vector3& axis, double low, double high) {
  Triangles kept;
  for (const Triangle& t : triangles) {
    const auto [least, most] = std::minmax({axis.dot(t[0]), axis.dot(t[1]), axis.dot(t[2])});
    if (most < low || least > high) continue;
    if (least >= low && most <= high) {
      kept.push_back(t);
      continue;
    }
    const Points polygon = cut(cut({t.begin(), t.end()}, axis, low, 1.0), axis, high, -1.0);
    for (std::size_t i = 2; i < polygon.size(); ++i) kept.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }
  return kept;
}

Points hull_points(const Points& points) {
  Points distinct = points;
  std::sort(distinct.begin(), distinct.end(), [](const Vector3& a, const Vector3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  if (distinct.size() < 5) return distinct;
  std::optional<ConvexHull> hull = config::convex_hull(distinct);
  return hull ? std::move(hull->vertices) : distinct;
}

Points extreme_points(const Points& points, int count) {
  if (static_cast<int>(points.size()) <= count) return points;
  std::set<std::size_t> chosen;
  std::vector<double> along(points.size());
  for (int k = 0; k < count; ++k) {
    const Vector3 direction = spiral(1.0 - (2.0 * k + 1.0) / count, k);
    std::transform(points.begin(), points.end(), along.begin(), [&](const Vector3& p) { return direction.dot(p); });
    chosen.insert(static_cast<std::size_t>(std::max_element(along.begin(), along.end()) - along.begin()));
  }
  Points extremes;
  for (const std::size_t i : chosen) extremes.push_back(points[i]);
  return extremes;
}

std::vector<Vector3> half_sphere(int count) {
  std::vector<Vector3> directions;
  for (int k = 0; k < count; ++k) directions.push_back(spiral(1.0 - (k + 0.5) / count, k));
  return directions;
}

Matrix3 principal_axes(const Points& points) {
  Vector3 mean = Vector3::Zero();
  for (const Vector3& p : points) mean += p / static_cast<double>(points.size());
  Matrix3 scatter = Matrix3::Zero();
  for (const Vector3& p : points) scatter += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(scatter);
  Matrix3 axes = solver.eigenvectors().rowwise().reverse();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

}  // namespace moma::fit
