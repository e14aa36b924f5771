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

  Vector3 project(const Vector3& p_W) const {
    Vector3 p = X.linear().transpose() * (p_W - X.translation());
    if (shape.kind == ShapeKind::kBox) {
      p = p.cwiseMax(-half).cwiseMin(half);
    } else {
      const double r = p.head<2>().norm();
      if (r > half.x()) p.head<2>() *= half.x() / r;
      p.z() = std::clamp(p.z(), -half.z(), half.z());
    }
    return X.linear() * p + X.translation();
  }

  /// min over the core of direction . p.
  double least(const Vector3& direction_W) const {
    const Vector3 d = X.linear().transpose() * direction_W;
    const double reach = shape.kind == ShapeKind::kBox ? d.cwiseAbs().dot(half)
                                                       : half.x() * d.head<2>().norm() + half.z() * std::abs(d.z());
    return direction_W.dot(X.translation()) - reach;
  }
};

struct Nearest {
  Vector3 a, b;
  double lower = -1.0;  // proved bound of the cores' distance; -1 where none was found
};

/// Nearest points of two cores: until the bounds decide about `radius`, the sum of the balls, or nothing moves.
Nearest nearest(const Solid& A, const Solid& B, double radius) {
  Nearest best;
  Vector3 b = B.project(A.X.translation());
  Vector3 y = b;
  double t = 1.0;
  for (int i = 0; i < kIterations; ++i) {
    const Vector3 a = A.project(y);
    const Vector3 next = B.project(a);
    const Vector3 gap = a - next;
    const double d = gap.norm();
    best.a = a;
    best.b = next;
    if (d < radius - kRounding || d < kRounding) return best;
    const Vector3 n = gap / d;
    best.lower = std::max(best.lower, A.least(n) + B.least(-n));
    if (best.lower > radius + kRounding && d - best.lower < 1e-6 * d) return best;
    const double t_next = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * t * t));
    const bool restart = (y - next).dot(next - b) > 0.0;
    y = restart ? next : Vector3(next + (t - 1.0) / t_next * (next - b));
    t = restart ? 1.0 : t_next;
    b = next;
  }
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
