#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "controller/fit/enclosing.h"

namespace moma::fit {
namespace {

constexpr int kFewOfCapsule = 256;  // number of points in the comparison of directions
constexpr int kAxes = 64;
constexpr std::size_t kRefinedAxes = 5;  // number of directions for the local search
constexpr int kCapsuleEvaluations = 400;
constexpr double kMostRadius = 0.7;  // log of the largest factor

struct Capsule {
  Vector3 middle = Vector3::Zero();
  Vector3 axis = Vector3::UnitZ();
  double radius = 0.0;
  double length = 0.0;
  double volume = std::numeric_limits<double>::infinity();
};

// The shortest capsule about the line through `origin` along `axis` with a radius of `factor` times the smallest. A
// point at axial position t and distance r from the line is inside if t is at most sqrt(R^2 - r^2) beyond an end.
class Line {
 public:
  Line(const Points& points, const Vector3& origin, const Vector3& axis)
      : points_(points), origin_(origin), axis_(axis) {
    for (const Vector3& p : points_) squared_ = std::max(squared_, off(p));
  }

  Capsule capsule(double factor) const {
    Capsule c;
    c.axis = axis_;
    c.radius = std::max(factor * std::sqrt(squared_), 0.5 * kThinnest);
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const Vector3& p : points_) {
      const double t = axis_.dot(p - origin_);
      const double cap = std::sqrt(std::max(0.0, c.radius * c.radius - off(p)));
      low = std::min(low, t + cap);
      high = std::max(high, t - cap);
    }
    c.length = std::max(0.0, high - low);
    c.middle = origin_ + 0.5 * (low + high) * axis_;
    c.volume = volume({ShapeKind::kCapsule, {c.radius, c.length, 0.0}, nullptr});
    return c;
  }

 private:
  double off(const Vector3& p) const {
    const double t = axis_.dot(p - origin_);
    return (p - origin_ - t * axis_).squaredNorm();
  }

  const Points& points_;
  Vector3 origin_;
  Vector3 axis_;
  double squared_ = 0.0;
};

Matrix3 frame_along(const Vector3& axis) {
  const Vector3 x = axis.unitOrthogonal();
  Matrix3 frame;
  frame << x, axis.cross(x), axis;
  return frame;
}

// Returns the best capsule along `axis` through the middle of the smallest disc, with these factors of its radius.
Capsule along(const Points& points, const Vector3& axis, const std::vector<double>& factors) {
  const Matrix3 frame = frame_along(axis);
  std::vector<Vector2> flat;
  for (const Vector3& p : points) flat.emplace_back(frame.col(0).dot(p), frame.col(1).dot(p));
  const Vector2 centre = smallest_ball<2>(flat).centre;
  const Line line(points, frame.leftCols<2>() * centre, axis);
  Capsule best;
  for (const double factor : factors) {
    const Capsule capsule = line.capsule(factor);
    if (capsule.volume < best.volume) best = capsule;
  }
  return best;
}

double smallest_radius(const Points& points, const Capsule& capsule) {
  double squared = 0.0;
  for (const Vector3& p : points) squared = std::max(squared, (p - capsule.middle).cross(capsule.axis).squaredNorm());
  return std::sqrt(squared);
}

// Local search over two tilts, two shifts (in units of the radius) and the logarithm of the radius's factor.
Capsule refined(const Points& points, const Capsule& start) {
  const Matrix3 frame = frame_along(start.axis);
  const auto at = [&](const std::vector<double>& x) {
    const Vector3 axis = (frame * Vector3(x[0], x[1], 1.0)).normalized();
    const Vector3 origin = start.middle + start.radius * (x[2] * frame.col(0) + x[3] * frame.col(1));
    return Line(points, origin, axis).capsule(std::exp(x[4]));
  };
  const double least = smallest_radius(points, start);
  const double log_factor = least > 0.0 ? std::clamp(std::log(start.radius / least), 0.0, kMostRadius) : 0.0;
  const std::vector<double> x =
      minimise([&](const std::vector<double>& v) { return at(v).volume; },
               {{0, 0, 0, 0, log_factor}, {0.1, 0.1, 0.1, 0.1, 0.05}, {-1, -1, -1, -1, 0}, {1, 1, 1, 1, kMostRadius}},
               kCapsuleEvaluations);
  const Capsule found = at(x);
  return found.volume < start.volume ? found : start;
}

}  // namespace

Solid enclosing_capsule(const Points& points, Effort effort) {
  const Points few = extreme_points(points, kFewOfCapsule);
  const Matrix3 principal = principal_axes(few);
  std::vector<Vector3> directions;
  for (int i = 0; i < 3; ++i) directions.emplace_back(Vector3::Unit(i));
  for (int i = 0; i < 3; ++i) directions.emplace_back(principal.col(i));
  if (effort == Effort::kThorough)
    for (const Vector3& d : half_sphere(kAxes)) directions.push_back(d);
  const std::vector<double> factors{1.0, 1.04, 1.12, 1.25};
  std::vector<Capsule> found;
  for (const Vector3& d : directions) found.push_back(along(few, d, factors));
  std::stable_sort(found.begin(), found.end(), [](const Capsule& a, const Capsule& b) { return a.volume < b.volume; });
  Capsule best = found.front();
  if (effort == Effort::kThorough) {
    for (std::size_t i = 0; i < std::min(kRefinedAxes, found.size()); ++i) {
      const Capsule candidate = refined(few, found[i]);
      if (candidate.volume < best.volume) best = candidate;
    }
    // The few points were most of the hull: repeats with all of it.
    const double least = smallest_radius(points, best);
    best = refined(points, Line(points, best.middle, best.axis).capsule(std::max(1.0, best.radius / least)));
    std::vector<double> fine;
    for (int i = 0; i <= 50; ++i) fine.push_back(1.0 + 0.01 * i);
    Capsule aligned;
    for (int i = 0; i < 3; ++i) {
      const Capsule candidate = along(points, Vector3::Unit(i), fine);
      if (candidate.volume < aligned.volume) aligned = candidate;
    }
    if (aligned.volume <= kAlignedGain * best.volume) best = aligned;
  }
  Solid solid;
  solid.shape = {ShapeKind::kCapsule, {best.radius, best.length, 0.0}, nullptr};
  solid.X_LS = pose_of(frame_along(best.axis), best.middle);
  return solid;
}

Solid enclosing_sphere(const Points& points) {
  const Ball<3> ball = smallest_ball<3>(points);
  Solid solid;
  solid.shape = {ShapeKind::kSphere, {std::max(ball.radius, 0.5 * kThinnest), 0.0, 0.0}, nullptr};
  solid.X_LS.translation() = ball.centre;
  return solid;
}

}  // namespace moma::fit
