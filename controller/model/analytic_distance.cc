#include "controller/model/analytic_distance.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace moma {
namespace {

// v / |v|, or `otherwise` if v has no direction.
Vector3 direction(const Vector3& v, const Vector3& otherwise) noexcept {
  const double length = v.norm();
  return length > 1e-14 ? Vector3(v / length) : otherwise;
}

// A caller that needs the distance alone does not pay for the normal.
template <class Answer, class Normal>
Answer answer(double d, Normal normal) noexcept {
  if constexpr (std::is_same_v<Answer, double>) {
    return d;
  } else {
    return {d, normal()};
  }
}

template <class Answer>
Answer to_box(const Vector3& half, const Vector3& p) noexcept {
  const Vector3 beyond = p.cwiseAbs() - half;
  const Vector3 outside = beyond.cwiseMax(0.0);
  const double d = outside.norm();
  const auto sign = [](double x) { return std::copysign(1.0, x); };
  if (d > 1e-14)
    return answer<Answer>(d, [&]() -> Vector3 { return (outside.array() * p.array().unaryExpr(sign)) / d; });
  Eigen::Index i = 0;  // inside: the way out leads through the nearest face
  const double depth = beyond.maxCoeff(&i);
  return answer<Answer>(depth, [&]() -> Vector3 { return sign(p[i]) * Vector3::Unit(i); });
}

template <class Answer>
Answer to_cylinder(double radius, double half, const Vector3& p) noexcept {
  const double rho = std::hypot(p.x(), p.y());
  const double out = rho - radius;
  const double up = std::abs(p.z()) - half;
  const auto radial = [&]() -> Vector3 {
    return rho > 1e-14 ? Vector3(p.x() / rho, p.y() / rho, 0.0) : Vector3::UnitX();
  };
  const auto axial = [&]() -> Vector3 { return {0.0, 0.0, std::copysign(1.0, p.z())}; };
  if (out > 0.0 && up > 0.0) {
    const double d = std::hypot(out, up);
    return answer<Answer>(d, [&]() -> Vector3 { return (out * radial() + up * axial()) / d; });
  }
  return out > up ? answer<Answer>(out, radial) : answer<Answer>(up, axial);
}

template <class Answer>
Answer to_point(const Shape& shape, const Vector3& p) noexcept {
  switch (shape.kind) {
    case ShapeKind::kBox:
      return to_box<Answer>(0.5 * shape.size, p);
    case ShapeKind::kCylinder:
      return to_cylinder<Answer>(shape.size.x(), 0.5 * shape.size.y(), p);
    case ShapeKind::kCapsule: {
      const double half = 0.5 * shape.size.y();
      const Vector3 r = p - Vector3(0.0, 0.0, std::clamp(p.z(), -half, half));
      return answer<Answer>(r.norm() - shape.size.x(), [&] { return direction(r, Vector3::UnitX()); });
    }
    case ShapeKind::kSphere:
    case ShapeKind::kConvex:
      break;
  }
  return answer<Answer>(p.norm() - bounding_radius(shape), [&] { return direction(p, Vector3::UnitZ()); });
}

Distance sphere_against(const Shape& sphere, const Isometry& X_W1, const Shape& solid, const Isometry& X_W2) noexcept {
  const Vector3 centre = X_W1.translation();
  const PointDistance point = point_distance(solid, X_W2.inverse() * centre);
  Distance result;
  result.d = point.d - sphere.size.x();
  result.n_W = X_W2.linear() * point.n_S;
  result.p_first_W = centre - sphere.size.x() * result.n_W;
  result.p_second_W = centre - point.d * result.n_W;
  return result;
}

// Parameters in [-1, 1] of the closest points of two segments c1 + s a1 and c2 + t a2 (Ericson, Real-Time
// Collision Detection, 5.1.9, for segments given by centre and half vector).
Vector2 closest_parameters(const Vector3& c1, const Vector3& a1, const Vector3& c2, const Vector3& a2) noexcept {
  const Vector3 r = c1 - c2;
  const double a = a1.squaredNorm();
  const double e = a2.squaredNorm();
  const double b = a1.dot(a2);
  const double c = a1.dot(r);
  const double f = a2.dot(r);
  const auto clamp = [](double x) { return std::clamp(x, -1.0, 1.0); };
  const double denominator = a * e - b * b;  // 0 if the segments are parallel or a point
  double s = 0.0;
  if (denominator > 1e-12 * a * e) {
    s = clamp((b * f - c * e) / denominator);
  } else if (a > 0.0) {
    // Parallel: the middle of the overlap, so that the points do not jump.
    const double span = std::sqrt(e / a);
    const double middle = -c / a;
    const double low = std::max(-1.0, middle - span);
    const double high = std::min(1.0, middle + span);
    s = low <= high ? 0.5 * (low + high) : clamp(middle);
  }
  double t = e > 0.0 ? clamp((b * s + f) / e) : 0.0;
  if (a > 0.0) s = clamp((b * t - c) / a);
  if (denominator <= 1e-12 * a * e && e > 0.0) t = clamp((b * s + f) / e);
  return {s, t};
}

Distance capsule_capsule(const Shape& first, const Isometry& X_W1, const Shape& second, const Isometry& X_W2) noexcept {
  const Vector3 a1 = 0.5 * first.size.y() * X_W1.linear().col(2);
  const Vector3 a2 = 0.5 * second.size.y() * X_W2.linear().col(2);
  const Vector3 c1 = X_W1.translation();
  const Vector3 c2 = X_W2.translation();
  const Vector2 st = closest_parameters(c1, a1, c2, a2);
  const Vector3 p1 = c1 + st.x() * a1;
  const Vector3 p2 = c2 + st.y() * a2;
  const Vector3 between = p1 - p2;
  const double length = between.norm();
  Distance result;
  result.d = length - first.size.x() - second.size.x();
  if (length > 1e-12) {
    result.n_W = between / length;
  } else {
    // Crossing axes: out along their common normal, in either direction; axes in line: along any normal of the axis.
    const Vector3 axis = X_W2.linear().col(2);
    const Vector3 side = direction(axis.unitOrthogonal(), Vector3::UnitX());
    result.n_W = direction(X_W1.linear().col(2).cross(axis), side);
  }
  result.p_first_W = p1 - first.size.x() * result.n_W;
  result.p_second_W = p2 + second.size.x() * result.n_W;
  return result;
}

Distance swapped(Distance distance) noexcept {
  distance.n_W = -distance.n_W;
  std::swap(distance.p_first_W, distance.p_second_W);
  return distance;
}

constexpr double kOutside = 1e-9;    // at smaller distances the axis counts as inside [m]
constexpr double kFlat = 1e-13;      // smaller slopes count as zero
constexpr int kMaxEvaluations = 80;  // bisection alone would need 55

struct Sample {
  double t = 0.0;
  PointDistance point;
  double slope = 0.0;  // derivative of the distance along the axis, per unit of its length
};

}  // namespace

PointDistance point_distance(const Shape& shape, const Vector3& p) noexcept {
  return to_point<PointDistance>(shape, p);
}
double point_gap(const Shape& shape, const Vector3& p) noexcept { return to_point<double>(shape, p); }

std::optional<Distance> analytic_distance(const Shape& first, const Isometry& X_W1, const Shape& second,
                                          const Isometry& X_W2) noexcept {
  if (first.kind == ShapeKind::kSphere && second.kind != ShapeKind::kConvex)
    return sphere_against(first, X_W1, second, X_W2);
  if (second.kind == ShapeKind::kSphere && first.kind != ShapeKind::kConvex)
    return swapped(sphere_against(second, X_W2, first, X_W1));
  if (first.kind == ShapeKind::kCapsule && second.kind == ShapeKind::kCapsule)
    return capsule_capsule(first, X_W1, second, X_W2);
  if (first.kind == ShapeKind::kCapsule) return capsule_distance(first, X_W1, second, X_W2);
  if (second.kind == ShapeKind::kCapsule) {
    if (const auto result = capsule_distance(second, X_W2, first, X_W1)) return swapped(*result);
  }
  return std::nullopt;
}

std::optional<Distance> capsule_distance(const Shape& capsule, const Isometry& X_W1, const Shape& solid,
                                         const Isometry& X_W2) noexcept {
  if (capsule.kind != ShapeKind::kCapsule || (solid.kind != ShapeKind::kBox && solid.kind != ShapeKind::kCylinder))
    return std::nullopt;
  const double half = 0.5 * capsule.size.y();
  const Vector3 centre_S = X_W2.linear().transpose() * (X_W1.translation() - X_W2.translation());
  const Vector3 axis_S = X_W2.linear().transpose() * X_W1.linear().col(2);
  const auto sample = [&](double t) {
    Sample s;
    s.t = t;
    s.point = point_distance(solid, centre_S + t * axis_S);
    s.slope = s.point.n_S.dot(axis_S);
    return s;
  };

  Sample low = sample(-half), high = sample(half), best;
  if (low.point.d < kOutside || high.point.d < kOutside) return std::nullopt;
  if (std::abs(low.slope) <= kFlat && std::abs(high.slope) <= kFlat) {
    best = sample(0.0);
  } else if (low.slope >= -kFlat) {
    best = low;
  } else if (high.slope <= kFlat) {
    best = high;
  } else {
    double low_slope = low.slope, high_slope = high.slope;
    int moved = 0;  // end that moved last: an end that stays twice has its slope halved (Illinois)
    for (int i = 0; i < kMaxEvaluations; ++i) {
      const double middle = 0.5 * (low.t + high.t);
      double t = (low.t * high_slope - high.t * low_slope) / (high_slope - low_slope);
      if (i % 4 == 3 || !(t > low.t && t < high.t)) t = middle;
      if (t == low.t || t == high.t) break;  // the bracket is two neighbouring numbers
      best = sample(t);
      if (best.point.d < kOutside) return std::nullopt;
      if (std::abs(best.slope) <= kFlat) break;
      if (best.slope < 0.0) {
        low = best;
        low_slope = best.slope;
        if (moved < 0) high_slope *= 0.5;
        moved = -1;
      } else {
        high = best;
        high_slope = best.slope;
        if (moved > 0) low_slope *= 0.5;
        moved = 1;
      }
    }
  }
  if (best.point.d < kOutside) return std::nullopt;

  Distance result;
  const Vector3 point_W = X_W2 * (centre_S + best.t * axis_S);
  result.d = best.point.d - capsule.size.x();
  result.n_W = X_W2.linear() * best.point.n_S;
  result.p_first_W = point_W - capsule.size.x() * result.n_W;
  result.p_second_W = point_W - best.point.d * result.n_W;
  return result;
}

}  // namespace moma
