#include "controller/fit/cloud.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <new>
#include <numbers>
#include <set>

#include "controller/config/convex_hull.h"

namespace moma::fit {
namespace {

// A triangle cut by two planes has at most five corners.
struct Polygon {
  std::array<Vector3, 8> corner;
  int count = 0;
  void add(const Vector3& p) { corner[static_cast<std::size_t>(count++)] = p; }
};

// Keeps the half with sign * (axis . x - at) >= 0.
Polygon cut(const Polygon& polygon, const Vector3& axis, double at, double sign) {
  Polygon kept;
  for (int i = 0; i < polygon.count; ++i) {
    const Vector3& a = polygon.corner[static_cast<std::size_t>(i)];
    const Vector3& b = polygon.corner[static_cast<std::size_t>((i + 1) % polygon.count)];
    const double from = sign * (axis.dot(a) - at);
    const double to = sign * (axis.dot(b) - at);
    if (from >= 0.0) kept.add(a);
    if ((from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0)) kept.add(a + from / (from - to) * (b - a));
  }
  return kept;
}

Vector3 spiral(double z, int k) {
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
  return {r * std::cos(golden * k), r * std::sin(golden * k), z};
}

bool lexicographic(const Vector3& a, const Vector3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

Points without_repetitions(Points points) {
  std::sort(points.begin(), points.end(), lexicographic);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

}  // namespace

Points corners(const Triangles& triangles) {
  Points points;
  points.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) points.insert(points.end(), t.begin(), t.end());
  return points;
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
    Polygon polygon;
    for (const Vector3& p : t) polygon.add(p);
    polygon = cut(cut(polygon, axis, low, 1.0), axis, high, -1.0);
    for (int i = 2; i < polygon.count; ++i)
      kept.push_back({polygon.corner[0], polygon.corner[static_cast<std::size_t>(i - 1)],
                      polygon.corner[static_cast<std::size_t>(i)]});
  }
  return kept;
}

Points hull_points(const Points& points) {
  Points distinct = without_repetitions(points);
  if (distinct.size() < 5) return distinct;
  try {
    return config::convex_hull(distinct).vertices;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return distinct;  // in one plane
  }
}

Points extreme_points(const Points& points, int count) {
  if (static_cast<int>(points.size()) <= count) return points;
  std::set<std::size_t> chosen;
  for (int k = 0; k < count; ++k) {
    const Vector3 direction = spiral(1.0 - (2.0 * k + 1.0) / count, k);
    std::size_t best = 0;
    double most = direction.dot(points[0]);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const double reach = direction.dot(points[i]);
      if (reach > most) {
        most = reach;
        best = i;
      }
    }
    chosen.insert(best);
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
