#pragma once

#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/model/ray_view.h"

namespace moma {

/// What a robot's sensors see of objects: how many rays of each sensor's latest frame end on each of them. The robot's
/// own shapes hide what is behind them; a shape in which a sensor lies hides nothing. Both sides use it: the simulation
/// with the truth, a controller with what it believes.
class SensorFrames {
 public:
  SensorFrames(const RobotModel& model, double control_period);  ///< `model` outlives it

  bool any() const noexcept { return !sensors_.empty(); }
  int count() const noexcept { return static_cast<int>(sensors_.size()); }
  /// For these objects; forgets the frames. Takes memory.
  void set_objects(std::span<const Shape> shapes);

  /// Takes the frames that are due at step k: one in each 1 / rate, at least a control period. Objects that are not
  /// `visible` are not there. Allocates nothing.
  void look(long k, const Kinematics& robot, std::span<const ObjectState> objects) noexcept;

  /// Whether the last look() took a frame of this sensor, and the time between two of them [s].
  bool due(int sensor) const noexcept { return at(sensor).due; }
  double interval(int sensor) const noexcept { return static_cast<double>(at(sensor).every) * dt_; }
  /// Rays of the sensor's latest frame that ended on the object, and of all sensors together.
  int rays_on(int sensor, std::size_t object) const noexcept { return at(sensor).hits[object]; }
  int rays_on(std::size_t object) const noexcept;
  /// Where the sensor was in its latest frame.
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
