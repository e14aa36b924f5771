#include "controller/model/segment_distance.h"

#include <cmath>

namespace moma {
namespace {

constexpr double kOutside = 1e-9;    // at smaller distances the axis counts as inside [m]
constexpr double kFlat = 1e-13;      // smaller slopes count as zero
constexpr int kMaxEvaluations = 80;  // bisection alone would need 55

struct Sample {
  double t = 0.0;
  PointDistance point;
  double slope = 0.0;  // derivative of the distance along the axis, per unit of its length
};

}  // namespace

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
