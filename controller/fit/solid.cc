#include "controller/fit/solid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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
  const Vector3 p = solid.X_LS.linear().transpose() * (p_L - solid.X_LS.translation());
  const Vector3& s = solid.shape.size;
  switch (solid.shape.kind) {
    case ShapeKind::kSphere:
      return p.norm() - s.x();
    case ShapeKind::kCapsule: {
      const double beyond = std::max(0.0, std::abs(p.z()) - 0.5 * s.y());
      return std::sqrt(p.x() * p.x() + p.y() * p.y() + beyond * beyond) - s.x();
    }
    default: {
      const Vector3 beyond = p.cwiseAbs() - 0.5 * s;
      return beyond.cwiseMax(0.0).norm() + std::min(0.0, beyond.maxCoeff());
    }
  }
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

}  // namespace moma::fit
