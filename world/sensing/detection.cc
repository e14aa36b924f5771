#include "world/sensing/detection.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "controller/model/analytic_distance.h"

namespace moma {
namespace {

constexpr int kRays = 2;  // least number of rays of the robot's sensors that end on a visible object
constexpr double kWhole = 2.0 * std::numbers::pi;
constexpr double kRay = 1e-3;    // [m], radius of a line of sight
constexpr double kShort = 0.01;  // length left free at its end, where the object itself is [m]

// A thin capsule from one point to another.
std::pair<Shape, Isometry> ray(const Vector3& from, const Vector3& to) {
  const Vector3 way = to - from;
  const double length = way.norm();
  Isometry X = Isometry::Identity();
  X.translation() = 0.5 * (from + to);
  if (length > 0.0) X.linear() = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), way).toRotationMatrix();
  return {Shape{ShapeKind::kCapsule, Vector3(kRay, length, 0.0), nullptr}, X};
}

bool contains(const Shape& shape, const Isometry& X_W, const Vector3& p_W) {
  return point_gap(shape, X_W.inverse() * p_W) <= 0.0;
}

bool blocks(const Shape& shape, const Isometry& X_W, const Vector3& from, const Vector3& to) {
  // Tests a bounding sphere first: most objects are elsewhere.
  const Vector3 way = to - from;
  const double square = way.squaredNorm();
  const double at = square > 0.0 ? std::clamp((X_W.translation() - from).dot(way) / square, 0.0, 1.0) : 0.0;
  if ((from + at * way - X_W.translation()).norm() > bounding_radius(shape) + kRay) return false;
  if (contains(shape, X_W, from)) return false;
  const auto [line, X_WL] = ray(from, to);
  // Empty if the line runs inside a box or a cylinder, and for hulls, where the sphere decides.
  const auto distance = analytic_distance(line, X_WL, shape, X_W);
  return !distance || distance->d <= 0.0;
}

}  // namespace

Detection::Detection(const DetectionRule& rule, const World& world, const DisturbanceStreams& streams,
                     double control_period, std::shared_ptr<const RobotModel> model)
    : rule_(rule),
      streams_(streams),
      model_(std::move(model)),
      steps_(delay_steps(rule.detection, control_period)),
      missed_span_(std::max(1L, delay_steps(rule.missed.duration, control_period))),
      on_(std::isfinite(rule.range) || steps_ > 0 || rule.field_of_view < kWhole || rule.occlusion ||
          rule.missed.probability > 0.0 || by_sensors()),
      in_range_(world.objects.size(), 0),
      found_(world.objects.size(), 0) {
  shapes_.reserve(world.objects.size());
  for (const WorldObject& object : world.objects) shapes_.push_back(object.shape);
  if (model_ == nullptr) return;
  if (rule_.mount == SensorMount::kHand || rule_.occlusion || by_sensors()) kinematics_.emplace(model_);
  if (by_sensors()) frames_.emplace(*model_, control_period).set_objects(shapes_);
}

const Vector3& Detection::sensor_W(const Vector3& p_W) const noexcept {
  const Vector3* nearest = &sensor_W_;
  for (int sensor = 0; frames_ && sensor < frames_->count(); ++sensor) {
    const Vector3& place = frames_->place_W(sensor);
    if (sensor == 0 || (place - p_W).squaredNorm() < (*nearest - p_W).squaredNorm()) nearest = &place;
  }
  return *nearest;
}

void Detection::place(const Vector3& base, const VectorX& q) {
  if (kinematics_) kinematics_->update(base, q);
  const Vector3 p(rule_.sensor[0], rule_.sensor[1], rule_.sensor[2]);
  const Vector3 axis(rule_.axis[0], rule_.axis[1], rule_.axis[2]);
  if (kinematics_ && rule_.mount == SensorMount::kHand) {
    sensor_W_ = kinematics_->X_WE() * p;
    axis_W_ = kinematics_->X_WE().linear() * axis;
    return;
  }
  const double c = std::cos(base.z()), s = std::sin(base.z());
  sensor_W_ = Vector3(base.x() + c * p[0] - s * p[1], base.y() + s * p[0] + c * p[1], p[2]);
  axis_W_ = Vector3(c * axis[0] - s * axis[1], s * axis[0] + c * axis[1], axis[2]);
}

bool Detection::hidden(std::size_t i, const Vector3& point_W, const std::vector<ObjectState>& objects) {
  const Vector3 way = point_W - sensor_W_;
  const double length = way.norm();
  if (length <= kShort) return false;
  const Vector3 to = sensor_W_ + (1.0 - kShort / length) * way;
  for (std::size_t j = 0; j < objects.size(); ++j)
    if (j != i && blocks(shapes_[j], objects[j].X_WO, sensor_W_, to)) return true;
  if (!kinematics_) return false;
  for (const CollisionShape& shape : model_->shapes)
    if (blocks(shape.shape, kinematics_->X_WS(shape), sensor_W_, to)) return true;
  return false;
}

bool Detection::near(std::size_t i, const std::vector<ObjectState>& objects) {
  return frames_ ? frames_->rays_on(i) >= kRays : in_range(i, objects);
}

bool Detection::in_range(std::size_t i, const std::vector<ObjectState>& objects) {
  const Isometry& X_WO = objects[i].X_WO;
  const Vector3 sensor_O = X_WO.linear().transpose() * (sensor_W_ - X_WO.translation());
  const PointDistance nearest = point_distance(shapes_[i], sensor_O);
  if (!(nearest.d <= rule_.range)) return false;
  if (rule_.field_of_view >= kWhole && !rule_.occlusion) return true;
  if (nearest.d <= 0.0) return true;  // the sensor is inside it
  const double least = std::cos(0.5 * rule_.field_of_view);
  for (const Vector3& point :
       {Vector3(sensor_W_ - nearest.d * (X_WO.linear() * nearest.n_S)), Vector3(X_WO.translation())}) {
    const Vector3 way = point - sensor_W_;
    if (rule_.field_of_view < kWhole && way.dot(axis_W_) < least * way.norm() * axis_W_.norm()) continue;
    if (!rule_.occlusion || !hidden(i, point, objects)) return true;
  }
  return false;
}

void Detection::update(long k, const Vector3& base, const VectorX& q, std::vector<ObjectState>& objects) {
  place(base, q);
  if (frames_) frames_->look(k, *kinematics_, objects);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    bool seen = found_[i] != 0;
    if (!seen || rule_.lost || frames_) {
      // In range at the first step counts as 1, so that the object is found after the time `detection`.
      const bool near = this->near(i, objects);
      in_range_[i] = !near ? 0 : first_ && rule_.known_at_start ? steps_ + 1 : in_range_[i] + 1;
      seen = seen ? near : in_range_[i] > steps_;
      if (seen) found_[i] = 1;
    }
    if (rule_.missed.probability > 0.0 && seen)
      seen =
          streams_.sensing(DisturbanceSource::kObjectMissed, k / missed_span_, i).uniform() >= rule_.missed.probability;
    if (!seen) objects[i].visible = false;
  }
  first_ = false;
}

}  // namespace moma
