#include "world/motion.h"

#include <algorithm>
#include <cstddef>

namespace moma {
namespace {

/// Returns the index i of the interval [times[i], times[i + 1]) that contains t; times.front() <= t < times.back().
std::size_t interval(const std::vector<double>& times, double t) {
  const auto after = std::upper_bound(times.begin(), times.end(), t);
  return static_cast<std::size_t>(after - times.begin()) - 1;
}

/// True if t is outside the knots, where the pose stays at an end; writes the index of that end.
bool held(const std::vector<double>& times, double t, std::size_t& end) {
  if (t < times.front()) {
    end = 0;
    return true;
  }
  if (t >= times.back()) {
    end = times.size() - 1;
    return true;
  }
  return false;
}

MovingPose move(const StaticMotion&, const Isometry& X_0, double) { return {X_0, Vector6::Zero()}; }

MovingPose move(const LinearMotion& motion, const Isometry& X_0, double t) {
  MovingPose out{X_0, motion.V_W};
  const Vector3 w = motion.V_W.head<3>();
  const double rate = w.norm();
  if (rate > 0.0) out.X.linear() = Eigen::AngleAxisd(rate * t, w / rate).toRotationMatrix() * X_0.linear();
  out.X.translation() += t * motion.V_W.tail<3>();
  return out;
}

MovingPose move(const PathMotion& motion, const Isometry& X_0, double t) {
  MovingPose out{X_0, Vector6::Zero()};
  if (motion.times.empty()) return out;
  const bool turns = !motion.quaternions.empty();
  std::size_t i = 0;
  if (held(motion.times, t, i)) {
    out.X.translation() = motion.positions[i];
    if (turns) out.X.linear() = motion.quaternions[i].normalized().toRotationMatrix();
    return out;
  }
  i = interval(motion.times, t);
  const double span = motion.times[i + 1] - motion.times[i];
  const double s = (t - motion.times[i]) / span;
  const Vector3 step = motion.positions[i + 1] - motion.positions[i];
  out.X.translation() = motion.positions[i] + s * step;
  out.V_W.tail<3>() = step / span;
  if (turns) {
    // Slerp as a constant world-frame rate, so that pose and twist agree by construction.
    const Eigen::Quaterniond from = motion.quaternions[i].normalized();
    Eigen::Quaterniond turn = motion.quaternions[i + 1].normalized() * from.conjugate();
    if (turn.w() < 0.0) turn.coeffs() = -turn.coeffs();
    const Eigen::AngleAxisd rotation(turn);
    out.X.linear() =
        Eigen::AngleAxisd(s * rotation.angle(), rotation.axis()).toRotationMatrix() * from.toRotationMatrix();
    out.V_W.head<3>() = rotation.axis() * (rotation.angle() / span);
  }
  return out;
}

MovingPose move(const CircleMotion& motion, const Isometry& X_0, double t) {
  const Vector3 axis = motion.axis.normalized();
  const Matrix3 turn = Eigen::AngleAxisd(motion.rate * t, axis).toRotationMatrix();
  MovingPose out;
  const Vector3 arm = turn * (X_0.translation() - motion.center);
  out.X.linear() = turn * X_0.linear();
  out.X.translation() = motion.center + arm;
  out.V_W.head<3>() = motion.rate * axis;
  out.V_W.tail<3>() = (motion.rate * axis).cross(arm);
  return out;
}

/// Returns the second derivatives at the knots of the natural cubic spline (zero at both ends), by the Thomas
/// algorithm.
std::vector<Vector3> second_derivatives(const SplineMotion& motion) {
  const std::size_t n = motion.times.size();
  std::vector<Vector3> m(n, Vector3::Zero());
  std::vector<double> upper(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double h0 = motion.times[i] - motion.times[i - 1];
    const double h1 = motion.times[i + 1] - motion.times[i];
    const Vector3 right = 6.0 * ((motion.positions[i + 1] - motion.positions[i]) / h1 -
                                 (motion.positions[i] - motion.positions[i - 1]) / h0);
    const double pivot = 2.0 * (h0 + h1) - h0 * upper[i - 1];
    upper[i] = h1 / pivot;
    m[i] = (right - h0 * m[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) m[i] -= upper[i] * m[i + 1];
  return m;
}

MovingPose move(const SplineMotion& motion, const Isometry& X_0, double t) {
  MovingPose out{X_0, Vector6::Zero()};
  if (motion.times.empty()) return out;
  std::size_t i = 0;
  if (held(motion.times, t, i)) {
    out.X.translation() = motion.positions[i];
    return out;
  }
  i = interval(motion.times, t);
  const std::vector<Vector3> m = second_derivatives(motion);
  const double h = motion.times[i + 1] - motion.times[i];
  const double a = (motion.times[i + 1] - t) / h;
  const double b = (t - motion.times[i]) / h;
  const Vector3& p0 = motion.positions[i];
  const Vector3& p1 = motion.positions[i + 1];
  out.X.translation() = a * p0 + b * p1 + ((a * a * a - a) * m[i] + (b * b * b - b) * m[i + 1]) * (h * h / 6.0);
  out.V_W.tail<3>() = (p1 - p0) / h + ((3.0 * b * b - 1.0) * m[i + 1] - (3.0 * a * a - 1.0) * m[i]) * (h / 6.0);
  return out;
}

bool all_equal(const std::vector<Vector3>& points) {
  return std::ranges::all_of(points, [&](const Vector3& p) { return p == points.front(); });
}

bool rest(const StaticMotion&, double) { return true; }
bool rest(const LinearMotion& motion, double) { return motion.V_W.isZero(0.0); }
bool rest(const PathMotion& motion, double t) {
  if (motion.times.empty() || t >= motion.times.back()) return true;
  const bool same = std::ranges::all_of(
      motion.quaternions, [&](const auto& q) { return q.coeffs() == motion.quaternions.front().coeffs(); });
  return same && all_equal(motion.positions);
}
bool rest(const CircleMotion& motion, double) { return motion.rate == 0.0; }
bool rest(const SplineMotion& motion, double t) {
  return motion.times.empty() || t >= motion.times.back() || all_equal(motion.positions);
}

}  // namespace

MovingPose evaluate(const Motion& motion, const Isometry& X_0, double t) {
  return std::visit([&](const auto& kind) { return move(kind, X_0, t); }, motion);
}

bool at_rest(const Motion& motion, double t) {
  return std::visit([&](const auto& kind) { return rest(kind, t); }, motion);
}

PathMotion to_and_fro(const Vector3& from, const Vector3& to, double leg, double duration) {
  PathMotion motion;
  for (int k = 0; k * leg < duration + leg; ++k) {
    motion.times.push_back(k * leg);
    motion.positions.push_back(k % 2 == 0 ? from : to);
  }
  return motion;
}

}  // namespace moma
