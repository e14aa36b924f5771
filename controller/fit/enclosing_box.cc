#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "controller/config/convex_hull.h"
#include "controller/fit/enclosing.h"

namespace moma::fit {
namespace {

constexpr int kFewOfBox = 256;  // number of points in the comparison of normals
constexpr int kNormals = 32;
constexpr std::size_t kRefinedBoxes = 6;
constexpr int kMostTurns = 20;
constexpr int kBoxEvaluations = 300;

struct Box {
  Matrix3 axes = Matrix3::Identity();
  double volume = std::numeric_limits<double>::infinity();
};

double clamped_volume(const Vector3& size) { return size.cwiseMax(kThinnest).prod(); }

Eigen::AlignedBox3d extents(const Points& points, const Matrix3& axes) {
  Eigen::AlignedBox3d box;
  for (const Vector3& p : points) box.extend(axes.transpose() * p);
  return box;
}

// Hull of points in the plane, counter-clockwise (Andrew's monotone chain).
std::vector<Vector2> flat_hull(std::vector<Vector2> points) {
  const auto before = [](const Vector2& a, const Vector2& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vector2> hull;
  const auto add = [&](const Vector2& p, std::size_t base) {
    while (hull.size() >= base + 2) {
      const Vector2 a = hull[hull.size() - 1] - hull[hull.size() - 2];
      const Vector2 b = p - hull[hull.size() - 2];
      if (a.x() * b.y() - a.y() * b.x() > 0.0) break;
      hull.pop_back();
    }
    hull.push_back(p);
  };
  for (const Vector2& p : points) add(p, 0);
  const std::size_t base = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], base);
  hull.pop_back();
  return hull;
}

// Returns the smallest box with one axis along `normal`.
Box along(const Points& points, const Vector3& normal) {
  const Vector3 x = normal.unitOrthogonal();
  const Vector3 y = normal.cross(x);
  std::vector<Vector2> flat;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Vector3& p : points) {
    flat.emplace_back(x.dot(p), y.dot(p));
    low = std::min(low, normal.dot(p));
    high = std::max(high, normal.dot(p));
  }
  const std::vector<Vector2> hull = flat_hull(std::move(flat));
  Box best;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    Vector2 edge = hull[(i + 1) % hull.size()] - hull[i];
    if (edge.norm() < 1e-12) {
      if (hull.size() > 1) continue;
      edge = Vector2::UnitX();
    }
    edge.normalize();
    const Vector2 across(-edge.y(), edge.x());
    Eigen::AlignedBox2d rectangle;
    for (const Vector2& p : hull) rectangle.extend(Vector2(edge.dot(p), across.dot(p)));
    const double size = clamped_volume({rectangle.sizes().x(), rectangle.sizes().y(), high - low});
    if (size >= best.volume) continue;
    best.volume = size;
    best.axes << edge.x() * x + edge.y() * y, across.x() * x + across.y() * y, normal;
  }
  return best;
}

// Uses the box's own axes as normals in turn, while that helps.
Box turned(const Points& points, Box box) {
  for (int turn = 0; turn < kMostTurns; ++turn) {
    Box best = box;
    for (int i = 0; i < 3; ++i) {
      const Box next = along(points, box.axes.col(i));
      if (next.volume < best.volume) best = next;
    }
    if (!(best.volume < box.volume * (1.0 - 1e-9))) break;
    box = best;
  }
  return box;
}

Box refined(const Points& points, const Box& start) {
  const auto axes = [&](const std::vector<double>& x) -> Matrix3 {
    const Vector3 turn(x[0], x[1], x[2]);
    const double angle = turn.norm();
    if (angle < 1e-15) return start.axes;
    return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * start.axes;
  };
  const auto size = [&](const std::vector<double>& x) { return clamped_volume(extents(points, axes(x)).sizes()); };
  const std::vector<double> x =
      minimise(size, {{0, 0, 0}, {0.03, 0.03, 0.03}, {-0.8, -0.8, -0.8}, {0.8, 0.8, 0.8}}, kBoxEvaluations);
  const double found = size(x);
  return found < start.volume ? Box{axes(x), found} : start;
}

// Orders and orients axes as near to the link's as possible, for readable angles.
Matrix3 tidy(const Matrix3& axes) {
  Matrix3 best = axes;
  double most = -4.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      for (int signs = 0; signs < 4; ++signs) {
        const Vector3 x = (signs % 2 == 0 ? 1.0 : -1.0) * axes.col(i);
        const Vector3 y = (signs / 2 == 0 ? 1.0 : -1.0) * axes.col(j);
        Matrix3 candidate;
        candidate << x, y, x.cross(y);
        if (candidate.trace() > most + 1e-9) {
          most = candidate.trace();
          best = candidate;
        }
      }
    }
  }
  return best;
}

std::vector<Vector3> normals(const Points& points, Effort effort) {
  const Matrix3 principal = principal_axes(points);
  std::vector<Vector3> all{Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ(), principal.col(0), principal.col(2)};
  if (effort == Effort::kQuick) return all;
  for (const Vector3& d : half_sphere(kNormals)) all.push_back(d);
  // Without a hull all points lie in one plane, whose normal is the last principal axis.
  const std::optional<ConvexHull> hull = points.size() < 5 ? std::nullopt : config::convex_hull(points);
  for (std::size_t i = 0; hull && i < hull->triangles.size(); ++i) {
    const auto [a, b, c] = config::corners(hull->vertices, hull->triangles[i]);
    const Vector3 n = (b - a).cross(c - a);
    if (n.norm() > 1e-12) all.emplace_back(n.normalized());
  }
  return all;
}

}  // namespace

Solid enclosing_box(const Points& points, Effort effort) {
  const Points few = extreme_points(points, kFewOfBox);
  std::vector<Box> found;
  for (const Vector3& n : normals(few, effort)) found.push_back(along(few, n));
  std::stable_sort(found.begin(), found.end(), [](const Box& a, const Box& b) { return a.volume < b.volume; });
  Box best = found.front();
  if (effort == Effort::kThorough) {
    for (std::size_t i = 0; i < std::min(kRefinedBoxes, found.size()); ++i) {
      const Box candidate = turned(few, found[i]);
      if (candidate.volume < best.volume) best = candidate;
    }
    best = turned(points, along(points, best.axes.col(2)));
    best = refined(points, best);
  }
  if (clamped_volume(extents(points, Matrix3::Identity()).sizes()) <= kAlignedGain * best.volume)
    best.axes = Matrix3::Identity();
  Solid solid;
  solid.X_LS.linear() = tidy(best.axes);
  const Eigen::AlignedBox3d box = extents(points, solid.X_LS.linear());
  solid.shape = {ShapeKind::kBox, box.sizes().cwiseMax(kThinnest), nullptr};
  solid.X_LS.translation() = solid.X_LS.linear() * box.center();
  return solid;
}

}  // namespace moma::fit
