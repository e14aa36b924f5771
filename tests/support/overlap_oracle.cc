#include "tests/support/overlap_oracle.h"

#include <algorithm>
#include <cmath>

namespace moma::test {
namespace {

constexpr int kIterations = 50000;
// Of coordinates of about 1 m after a few rotations [m].
constexpr double kRounding = 1e-12;

/// A solid as the sum of a core (point, segment, box or cylinder) and a ball.
struct Solid {
  const Shape& shape;
  Isometry X;
  double radius = 0.0;             // of the ball
  Vector3 half = Vector3::Zero();  // box: half edges; cylinder: (radius, -, half length); segment: (0, -, half length)

  Solid(const Shape& s, const Isometry& X_W, double shrink) : shape(s), X(X_W) {
    switch (s.kind) {
      case ShapeKind::kSphere:
        radius = s.size.x() - shrink;
        break;
      case ShapeKind::kCapsule:
        radius = s.size.x() - shrink;
        half.z() = 0.5 * s.size.y();
        break;
      case ShapeKind::kBox:
        half = 0.5 * s.size - Vector3::Constant(shrink);
        break;
      default:
        half = Vector3(s.size.x() - shrink, 0.0, 0.5 * s.size.y() - shrink);
    }
  }

  /// The nearest point of the core, both in the solid's axes.
  Vector3 nearest(Vector3 p) const {
    if (shape.kind == ShapeKind::kBox) return p.cwiseMax(-half).cwiseMin(half);
    const double square = p.x() * p.x() + p.y() * p.y();
    if (square > half.x() * half.x()) p.head<2>() *= half.x() / std::sqrt(square);
    p.z() = std::clamp(p.z(), -half.z(), half.z());
    return p;
  }

  /// Largest d . p over the core, in the solid's axes.
  double reach(const Vector3& d) const {
    return shape.kind == ShapeKind::kBox
               ? std::abs(d.x()) * half.x() + std::abs(d.y()) * half.y() + std::abs(d.z()) * half.z()
               : half.x() * std::sqrt(d.x() * d.x() + d.y() * d.y()) + half.z() * std::abs(d.z());
  }

  /// min over the core of direction . p.
  double least(const Vector3& direction_W) const {
    return direction_W.dot(X.translation()) - reach(X.linear().transpose() * direction_W);
  }
};

struct Nearest {
  Vector3 a, b;
  double lower = -1.0;  // proved bound of the cores' distance; -1 where none was found
};

/// Nearest points of two cores: until the bounds decide about `radius`, the sum of the balls, or nothing moves. All in
/// A's axes.
Nearest nearest(const Solid& A, const Solid& B, double radius) {
  const Matrix3 R = A.X.linear().transpose() * B.X.linear(), R_T = R.transpose();
  const Vector3 p = A.X.linear().transpose() * (B.X.translation() - A.X.translation());
  const auto in_B = [&](const Vector3& a) -> Vector3 { return p + R * B.nearest(R_T * (a - p)); };
  Nearest best;
  Vector3 b = in_B(Vector3::Zero());
  Vector3 y = b;
  double t = 1.0;
  for (int i = 0; i < kIterations; ++i) {
    const Vector3 a = A.nearest(y);
    const Vector3 next = in_B(a);
    const Vector3 gap = a - next;
    const double d = gap.norm();
    best.a = a;
    best.b = next;
    if (d < radius - kRounding || d < kRounding) break;
    const Vector3 n = gap / d;
    best.lower = std::max(best.lower, -A.reach(n) - n.dot(p) - B.reach(R_T * n));
    if (best.lower > radius + kRounding && d - best.lower < 1e-6 * d) break;
    const double t_next = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * t * t));
    const bool restart = (y - next).dot(next - b) > 0.0;
    y = restart ? next : Vector3(next + (t - 1.0) / t_next * (next - b));
    t = restart ? 1.0 : t_next;
    b = next;
  }
  best.a = A.X * best.a;
  best.b = A.X * best.b;
  return best;
}

}  // namespace

OverlapResult overlap(const Shape& shape_A, const Isometry& X_WA, const Shape& shape_B, const Isometry& X_WB,
                      double depth) {
  OverlapResult out;
  const Solid A(shape_A, X_WA, 0.0), B(shape_B, X_WB, 0.0);
  const double radius = A.radius + B.radius;
  const Nearest whole = nearest(A, B, radius);
  if (whole.lower > radius + kRounding) {
    out.verdict = Overlap::kApart;
    out.gap = whole.lower - radius;
    out.p_A_W = whole.a;
    out.n_W = (whole.a - whole.b).normalized();
    return out;
  }
  const Solid a(shape_A, X_WA, 0.5 * depth), b(shape_B, X_WB, 0.5 * depth);
  const double small = a.radius + b.radius;
  const Nearest inside = nearest(a, b, small);
  if ((inside.a - inside.b).norm() < std::max(small, 1e-9))
    out.verdict = Overlap::kDeep;
  else if (inside.lower > small)
    out.verdict = Overlap::kBoundary;
  return out;
}

double least_along(const Shape& shape, const Isometry& X_WS, const Vector3& direction_W) {
  const Solid solid(shape, X_WS, 0.0);
  return solid.least(direction_W) - solid.radius * direction_W.norm();
}

}  // namespace moma::test
