#include "controller/fit/placed.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "controller/config/convex_hull.h"
#include "controller/config/robot_file.h"
#include "controller/model/analytic_distance.h"
#include "controller/model/kinematics.h"
#include "controller/model/sampling.h"

namespace moma::fit {
namespace {

constexpr double kPi = std::numbers::pi;

double surface_area(const Shape& shape) {
  const Vector3& s = shape.size;
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return 4.0 * kPi * s.x() * s.x();
    case ShapeKind::kCapsule:
      return 2.0 * kPi * s.x() * (s.y() + 2.0 * s.x());
    default:
      return 2.0 * (s.x() * s.y() + s.y() * s.z() + s.z() * s.x());
  }
}

// Point of the surface at u, v in [0, 1), equal areas for equal shares. The area of a sphere's zone is proportional to
// its height (Archimedes), as a cylinder's is, with the same factor: u therefore runs along the whole axis of a
// capsule.
Vector3 surface_point(const Shape& shape, double u, double v) {
  const double turn = 2.0 * kPi * v;
  if (shape.kind != ShapeKind::kBox) {
    const double radius = shape.size.x();
    const double half = shape.kind == ShapeKind::kCapsule ? 0.5 * shape.size.y() : 0.0;
    const double z = (2.0 * u - 1.0) * (half + radius);
    const double beyond = std::max(0.0, std::abs(z) - half);
    const double r = std::sqrt(std::max(0.0, radius * radius - beyond * beyond));
    return {r * std::cos(turn), r * std::sin(turn), z};
  }
  const double total = surface_area(shape);
  double at = u * total;
  for (int face = 0; face < 6; ++face) {
    const int i = face / 2;
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    const double area = shape.size[j] * shape.size[k];
    if (at < area || face == 5) {
      Vector3 p;
      p[i] = (face % 2 == 0 ? 0.5 : -0.5) * shape.size[i];
      p[j] = (std::min(at / area, 1.0) - 0.5) * shape.size[j];
      p[k] = (v - 0.5) * shape.size[k];
      return p;
    }
    at -= area;
  }
  return Vector3::Zero();
}

constexpr double kSlack = 1e-9;  // margin for rounding in later measurements [m]

double nearest(double value) { return std::round(value / kGrid) / std::round(1.0 / kGrid) + 0.0; }
double upward(double value) { return std::ceil((value + kSlack) / kGrid) / std::round(1.0 / kGrid); }

// A capsule is symmetric about its axis and reversible: no roll, and a pitch of at most a right angle.
Vector3 angles_of_axis(Vector3 axis) {
  if (axis.z() < 0.0) axis = -axis;
  const double across = std::hypot(axis.x(), axis.y());
  const double pitch = std::atan2(across, axis.z());
  return {0.0, pitch, nearest(pitch) > 0.0 ? std::atan2(axis.y(), axis.x()) : 0.0};
}

Vector3 size_around(const Shape& shape, const Isometry& X_LS, const Points& points) {
  const Isometry X_SL = X_LS.inverse();
  Vector3 box = Vector3::Zero();
  double ball = 0.0;
  double disc = 0.0;
  for (const Vector3& p : points) {
    const Vector3 local = X_SL * p;
    box = box.cwiseMax(local.cwiseAbs());
    ball = std::max(ball, local.norm());
    disc = std::max(disc, local.head<2>().norm());
  }
  if (shape.kind == ShapeKind::kSphere) return {upward(std::max(ball, 0.5 * kThinnest)), 0.0, 0.0};
  if (shape.kind == ShapeKind::kBox) {
    for (double& edge : box) edge = upward(std::max(2.0 * edge, kThinnest));
    return box;
  }
  const double radius = upward(std::max({disc, shape.size.x() - kSlack, 0.5 * kThinnest}));
  double half = 0.0;
  for (const Vector3& p : points) {
    const Vector3 local = X_SL * p;
    const double cap = std::sqrt(std::max(0.0, radius * radius - local.head<2>().squaredNorm()));
    half = std::max(half, std::abs(local.z()) - cap);
  }
  return {radius, std::max(upward(2.0 * half), kGrid), 0.0};
}

constexpr int kSurfaceSamples = 2000;
constexpr int kVolumeSamples = 32768;

double volume_of(const ConvexHull& hull) {
  double volume = 0.0;
  for (const Eigen::Vector3i& t : hull.triangles) {
    const auto [a, b, c] = config::corners(hull.vertices, t);
    const Vector3& o = hull.vertices[0];
    volume += (a - o).dot((b - o).cross(c - o)) / 6.0;
  }
  return volume;
}

}  // namespace

double volume(const Shape& shape) noexcept {
  const Vector3& s = shape.size;
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return 4.0 / 3.0 * kPi * s.x() * s.x() * s.x();
    case ShapeKind::kCapsule:
      return kPi * s.x() * s.x() * (s.y() + 4.0 / 3.0 * s.x());
    default:
      return s.prod();
  }
}

double distance(const Solid& solid, const Vector3& p_L) noexcept {
  return point_gap(solid.shape, solid.X_LS.linear().transpose() * (p_L - solid.X_LS.translation()));
}

double union_volume(std::span<const Solid> solids, int samples) {
  if (solids.size() == 1) return volume(solids[0].shape);
  Eigen::AlignedBox3d box;
  for (const Solid& solid : solids) {
    for (int i = 0; i < 3; ++i) {
      box.extend(support_point(solid.shape, solid.X_LS, Vector3::Unit(i)));
      box.extend(support_point(solid.shape, solid.X_LS, -Vector3::Unit(i)));
    }
  }
  int inside = 0;
  for (int i = 1; i <= samples; ++i) {
    const Vector3 share(halton(i, 2), halton(i, 3), halton(i, 5));
    const Vector3 p = box.min() + share.cwiseProduct(box.sizes());
    for (const Solid& solid : solids) {
      if (distance(solid, p) > 0.0) continue;
      ++inside;
      break;
    }
  }
  return box.volume() * inside / samples;
}

Points union_surface(std::span<const Solid> solids, int samples) {
  double total = 0.0;
  for (const Solid& solid : solids) total += surface_area(solid.shape);
  Points points;
  for (std::size_t s = 0; s < solids.size(); ++s) {
    const int count = static_cast<int>(std::ceil(samples * surface_area(solids[s].shape) / total));
    for (int i = 1; i <= count; ++i) {
      const Vector3 p = solids[s].X_LS * surface_point(solids[s].shape, halton(i, 2), halton(i, 3));
      bool covered = false;
      for (std::size_t t = 0; t < solids.size(); ++t) covered = covered || (t != s && distance(solids[t], p) < 0.0);
      if (!covered) points.push_back(p);
    }
  }
  return points;
}

Placed rounded(const Solid& solid, const Points& points) {
  Placed placed;
  for (int i = 0; i < 3; ++i) placed.position[i] = nearest(solid.X_LS.translation()[i]);
  if (solid.shape.kind != ShapeKind::kSphere) {
    const Matrix3 R = solid.X_LS.linear();
    placed.rpy = solid.shape.kind == ShapeKind::kCapsule ? angles_of_axis(R.col(2)) : rpy_of(R);
    for (double& angle : placed.rpy) angle = nearest(angle);
  }
  placed.solid.X_LS = pose_of(config::rotation_of(placed.rpy), placed.position);
  placed.solid.shape = {solid.shape.kind, size_around(solid.shape, placed.solid.X_LS, points), nullptr};
  return placed;
}

Placed as_it_is(const Shape& shape, const Isometry& X_LS) {
  Placed placed;
  placed.position = X_LS.translation();
  placed.rpy = rpy_of(X_LS.linear());
  placed.solid.shape = shape;
  placed.solid.X_LS = pose_of(config::rotation_of(placed.rpy), placed.position);
  return placed;
}

FitError measure(const Triangles& surface, const std::vector<Placed>& shapes) {
  FitError error;
  std::vector<Solid> solids;
  for (const Placed& placed : shapes) solids.push_back(placed.solid);
  const std::optional<ConvexHull> hull = config::convex_hull(corners(surface));
  const std::optional<config::DistanceOutside> from_hull =
      hull ? std::make_optional<config::DistanceOutside>(*hull) : std::nullopt;
  const double hull_volume = hull ? volume_of(*hull) : 0.0;
  if (hull_volume > 0.0) error.volume_ratio = union_volume(solids, kVolumeSamples) / hull_volume;
  const auto beyond = [&](const Vector3& p) {  // distance to the hull, 0 inside; to the surface itself if it is flat
    if (from_hull) return from_hull->of(p);
    double least = std::numeric_limits<double>::infinity();
    for (const Triangle& t : surface) least = std::min(least, config::distance_to_triangle(t, p));
    return least;
  };
  const Points samples = union_surface(solids, kSurfaceSamples);
  for (const Vector3& p : samples) {
    const double d = beyond(p);
    error.mean_overshoot += d / static_cast<double>(samples.size());
    error.most_overshoot = std::max(error.most_overshoot, d);
  }
  for (const Triangle& t : surface) {
    for (const Vector3& p : t) {
      double outside = std::numeric_limits<double>::infinity();
      for (const Solid& solid : solids) outside = std::min(outside, distance(solid, p));
      error.uncovered = std::max(error.uncovered, outside);
    }
  }
  return error;
}

}  // namespace moma::fit
