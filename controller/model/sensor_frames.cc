#include "controller/model/sensor_frames.h"

#include <algorithm>
#include <cmath>

namespace moma {
namespace {

constexpr int kRobot = -2;  // the robot's own shapes

}  // namespace

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
  for (One& one : sensors_) {
    one.due = k % one.every == 0;
    if (one.due) take(one, robot, objects);
  }
}

void SensorFrames::take(One& one, const Kinematics& robot, std::span<const ObjectState> objects) noexcept {
  const Isometry X_WC = robot.X_WL(one.mounted->link) * one.mounted->X_LC;
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
