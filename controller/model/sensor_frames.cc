#include "controller/model/sensor_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace moma {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The part of a ray inside all half-spaces so far.
struct Span {
  double in = -kInfinity, out = kInfinity;

  // Cuts by n.(p + t u) <= offset, with `height` = n.p - offset and `slope` = n.u.
  void cut(double height, double slope) noexcept {
    if (slope == 0.0) {
      if (height > 0.0) out = -kInfinity;
    } else if (const double t = -height / slope; slope < 0.0) {
      in = std::max(in, t);
    } else {
      out = std::min(out, t);
    }
  }
  // Distance at which the ray enters from outside.
  double entry() const noexcept { return in <= out && in > 0.0 ? in : kInfinity; }
};

double ray_to_ball(const Vector3& p, const Vector3& u, double radius) noexcept {
  const double along = p.dot(u), outside = p.squaredNorm() - radius * radius;
  const double root = along * along - outside;
  return outside > 0.0 && along < 0.0 && root >= 0.0 ? -along - std::sqrt(root) : kInfinity;
}

double ray_to_box(const Vector3& p, const Vector3& u, const Vector3& size) noexcept {
  Span span;
  for (int i = 0; i < 3; ++i) {
    span.cut(p[i] - 0.5 * size[i], u[i]);
    span.cut(-p[i] - 0.5 * size[i], -u[i]);
  }
  return span.entry();
}

// Span inside an infinite tube about z; empty if the ray misses it.
Span ray_through_tube(const Vector3& p, const Vector3& u, double radius) noexcept {
  const double a = u.head<2>().squaredNorm(), outside = p.head<2>().squaredNorm() - radius * radius;
  if (a == 0.0) return outside > 0.0 ? Span{kInfinity, -kInfinity} : Span{};
  const double b = p.head<2>().dot(u.head<2>()), root = b * b - a * outside;
  if (root < 0.0) return {kInfinity, -kInfinity};
  return {(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a};
}

double ray_to_cylinder(const Vector3& p, const Vector3& u, double radius, double length) noexcept {
  Span span = ray_through_tube(p, u, radius);
  span.cut(p.z() - 0.5 * length, u.z());
  span.cut(-p.z() - 0.5 * length, -u.z());
  return span.entry();
}

// A capsule is its cylinder and two balls.
double ray_to_capsule(const Vector3& p, const Vector3& u, double radius, double length) noexcept {
  const double beyond = std::max(0.0, std::abs(p.z()) - 0.5 * length);
  if (p.head<2>().squaredNorm() + beyond * beyond <= radius * radius) return kInfinity;
  const Vector3 end(0.0, 0.0, 0.5 * length);
  return std::min(
      {ray_to_cylinder(p, u, radius, length), ray_to_ball(p - end, u, radius), ray_to_ball(p + end, u, radius)});
}

double ray_to_hull(const Vector3& p, const Vector3& u, const ConvexHull& hull) noexcept {
  Span span;
  for (const Eigen::Vector3i& triangle : hull.triangles) {
    const auto corner = [&](int i) -> const Vector3& { return hull.vertices[static_cast<std::size_t>(triangle[i])]; };
    const Vector3 n = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    span.cut(n.dot(p - corner(0)), n.dot(u));
  }
  return span.entry();
}

// Angle of the i-th of `count` rays evenly spaced over twice `half`.
double angle_of(int i, int count, double half) noexcept { return half * ((2.0 * i + 1.0) / count - 1.0); }

// Index of the first ray with an angle of at least `from`.
int first_ray(double from, int count, double half) noexcept {
  if (half <= 0.0) return from <= 0.0 ? 0 : count;
  const double place = 0.5 * (count * (from / half + 1.0) - 1.0);
  return static_cast<int>(std::ceil(std::clamp(place - 1e-9, 0.0, static_cast<double>(count))));
}

constexpr int kRobot = -2;  // the robot's own shapes

}  // namespace

double ray_distance(const Shape& shape, const Vector3& from_S, const Vector3& u_S) noexcept {
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return ray_to_ball(from_S, u_S, shape.size[0]);
    case ShapeKind::kBox:
      return ray_to_box(from_S, u_S, shape.size);
    case ShapeKind::kCylinder:
      return ray_to_cylinder(from_S, u_S, shape.size[0], shape.size[1]);
    case ShapeKind::kCapsule:
      return ray_to_capsule(from_S, u_S, shape.size[0], shape.size[1]);
    case ShapeKind::kConvex:
      break;
  }
  return shape.hull ? ray_to_hull(from_S, u_S, *shape.hull) : kInfinity;
}

RayView::RayView(const Sensor& sensor)
    : columns_(sensor.columns),
      rows_(sensor.rows),
      range_(sensor.range),
      azimuth_(std::min(0.5 * sensor.field_of_view[0], kPi)),
      elevation_(std::min(0.5 * sensor.field_of_view[1], 0.5 * kPi)) {
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const double up = angle_of(row, rows_, elevation_), turn = angle_of(column, columns_, azimuth_);
      directions_.emplace_back(std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn), std::sin(up));
    }
  distances_.assign(directions_.size(), kInfinity);
  ids_.assign(directions_.size(), kNothing);
}

void RayView::begin(const Isometry& X_WC) noexcept {
  X_WC_ = X_WC;
  std::fill(distances_.begin(), distances_.end(), kInfinity);
  std::fill(ids_.begin(), ids_.end(), kNothing);
}

void RayView::draw(const Shape& shape, const Isometry& X_WS, int id) noexcept {
  const double radius = bounding_radius(shape);
  const Vector3 centre = X_WC_.linear().transpose() * (X_WS.translation() - X_WC_.translation());
  const double away = centre.norm();
  if (!(away - radius <= range_)) return;
  // Window of the solid's bounding ball: a cap of the sphere of directions, with its greatest azimuth (that of a
  // tangent meridian).
  Window rows{-kPi, kPi}, columns{-kPi, kPi};
  if (away > radius) {
    const double cap = std::asin(std::min(1.0, radius / away));
    const double up = std::asin(std::clamp(centre.z() / away, -1.0, 1.0));
    rows = {up - cap, up + cap};
    if (std::abs(up) + cap < 0.5 * kPi) {
      const double turn = std::atan2(centre.y(), centre.x());
      const double side = std::asin(std::min(1.0, std::sin(cap) / std::cos(up)));
      columns = {turn - side, turn + side};
    }
  }
  const Isometry X_SC = X_WS.inverse(Eigen::Isometry) * X_WC_;
  // A ray along u misses the tube about the solid's axis a through p if (u, a x p)^2 > r^2 |u x a|^2.
  const bool round = shape.kind == ShapeKind::kCylinder || shape.kind == ShapeKind::kCapsule;
  const Vector3 axis = X_SC.linear().row(2), moment = axis.cross(centre);
  const double square = shape.size[0] * shape.size[0];
  const auto misses = [&](const Vector3& u) {
    constexpr double kRounding = 1e-9;
    const double across = moment.dot(u), along = axis.dot(u);
    return across * across > square * (1.0 - along * along) + kRounding;
  };
  const int last_row = std::min(rows_, first_ray(rows.to, rows_, elevation_) + 1);
  for (const double turn : {0.0, 2.0 * kPi, -2.0 * kPi}) {  // the window may extend over the seam behind the sensor
    if (!(columns.to + turn >= -azimuth_ && columns.from + turn <= azimuth_)) continue;
    const int first = first_ray(columns.from + turn, columns_, azimuth_),
              last = std::min(columns_, first_ray(columns.to + turn, columns_, azimuth_) + 1);
    for (int row = first_ray(rows.from, rows_, elevation_); row < last_row; ++row)
      for (int column = first; column < last; ++column) {
        const auto ray = static_cast<std::size_t>(row * columns_ + column);
        const Vector3& u = directions_[ray];
        if (round && misses(u)) continue;
        const double d = ray_distance(shape, X_SC.translation(), X_SC.linear() * u);
        if (!(d < distances_[ray]) || d > range_) continue;
        distances_[ray] = d;
        ids_[ray] = id;
      }
  }
}

SensorFrames::SensorFrames(const RobotModel& model, double control_period) : model_(&model), dt_(control_period) {
  for (const MountedSensor& mounted : model.sensors) {
    const long every = std::max(1L, std::lround(1.0 / (mounted.sensor.rate * control_period)));
    sensors_.push_back({.mounted = &mounted, .view = RayView(mounted.sensor), .every = every, .hits = {}});
  }
}

void SensorFrames::set_objects(std::span<const Shape> shapes) {
  shapes_.assign(shapes.begin(), shapes.end());
  for (One& one : sensors_) one.hits.assign(shapes.size(), 0);
}

void SensorFrames::look(long k, const Kinematics& robot, std::span<const ObjectState> objects) noexcept {
  for (int i = 0; i < count(); ++i) {
    One& one = sensors_[static_cast<std::size_t>(i)];
    one.due = is_due(i, k);
    if (one.due) take(one, robot, objects);
  }
}

void SensorFrames::turn(int sensor, const Gaze& wanted) noexcept {
  One& one = sensors_[static_cast<std::size_t>(sensor)];
  const Head& head = one.mounted->sensor.head;
  if (!std::isfinite(wanted.pan) || !std::isfinite(wanted.tilt)) return;
  const Gaze to = head.within(wanted);
  const double most = head.speed * dt_;
  one.gaze.pan += std::clamp(to.pan - one.gaze.pan, -most, most);
  one.gaze.tilt += std::clamp(to.tilt - one.gaze.tilt, -most, most);
}

void SensorFrames::take(One& one, const Kinematics& robot, std::span<const ObjectState> objects) noexcept {
  const Isometry X_WC = robot.X_WL(one.mounted->link) * one.mounted->turned(one.gaze);
  one.p_W = X_WC.translation();
  one.view.begin(X_WC);
  for (std::size_t i = 0; i < shapes_.size(); ++i)
    if (objects[i].visible) one.view.draw(shapes_[i], objects[i].X_WO, static_cast<int>(i));
  for (const CollisionShape& shape : model_->shapes) one.view.draw(shape.shape, robot.X_WS(shape), kRobot);
  std::fill(one.hits.begin(), one.hits.end(), 0);
  for (const int id : one.view.ids())
    if (id >= 0) ++one.hits[static_cast<std::size_t>(id)];
}

int SensorFrames::rays_on(std::size_t object) const noexcept {
  int rays = 0;
  for (const One& one : sensors_) rays += one.hits[object];
  return rays;
}

}  // namespace moma
