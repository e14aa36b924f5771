#pragma once

#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/model/ray_view.h"

namespace moma {

/// Visibility of objects for a robot's sensors: the number of rays of each sensor's latest frame that end on each
/// object. The robot's own shapes occlude objects, except shapes that contain the sensor. The simulation uses it with
/// the true state, a controller with the believed one.
class SensorFrames {
 public:
  SensorFrames(const RobotModel& model, double control_period);  ///< `model` must outlive it

  bool any() const noexcept { return !sensors_.empty(); }
  int count() const noexcept { return static_cast<int>(sensors_.size()); }
  /// Sets the objects and clears the frames. Allocates.
  void set_objects(std::span<const Shape> shapes);

  /// Takes the frames that are due at step k: one per 1 / rate, at least a control period apart. Objects that are not
  /// `visible` do not exist here. Allocates nothing.
  void look(long k, const Kinematics& robot, std::span<const ObjectState> objects) noexcept;

  /// Whether the last look() took a frame of this sensor, and the time between two of them [s].
  bool due(int sensor) const noexcept { return at(sensor).due; }
  double interval(int sensor) const noexcept { return static_cast<double>(at(sensor).every) * dt_; }
  /// Number of rays of the sensor's latest frame that ended on the object; and over all sensors.
  int rays_on(int sensor, std::size_t object) const noexcept { return at(sensor).hits[object]; }
  int rays_on(std::size_t object) const noexcept;
  /// Position of the sensor in its latest frame.
  const Vector3& place_W(int sensor) const noexcept { return at(sensor).p_W; }

 private:
  struct One {
    const MountedSensor* mounted;
    RayView view;
    long every;  // control periods between frames
    bool due = false;
    Vector3 p_W = Vector3::Zero();
    std::vector<int> hits;
  };
  const One& at(int sensor) const noexcept { return sensors_[static_cast<std::size_t>(sensor)]; }
  void take(One& one, const Kinematics& robot, std::span<const ObjectState> objects) noexcept;

  const RobotModel* model_;
  double dt_;
  std::vector<One> sensors_;
  std::vector<Shape> shapes_;
};

}  // namespace moma
