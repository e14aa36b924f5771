#pragma once

#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/model/sensor.h"
#include "controller/model/shape.h"

namespace moma {

/// Distance from `from_S` along the unit vector `u_S` to the solid's surface, both in the solid's frame [m]; infinite
/// if the ray misses, or begins inside the solid. Exact for every kind; a hull is the intersection of the half-spaces
/// of its triangles.
double ray_distance(const Shape& shape, const Vector3& from_S, const Vector3& u_S) noexcept;

/// A sensor's frame: the nearest solid for each of its rays. Solids are drawn one after the other, each only in the
/// window of azimuth and elevation of its bounding ball: the cost is that of the rays near it. Only the constructor
/// allocates.
class RayView {
 public:
  static constexpr int kNothing = -1;  ///< id of a ray without a hit

  explicit RayView(const Sensor& sensor);

  /// Begins an empty frame from this pose.
  void begin(const Isometry& X_WC) noexcept;
  /// Draws a solid; its rays get `id`.
  void draw(const Shape& shape, const Isometry& X_WS, int id) noexcept;

  const Isometry& pose() const noexcept { return X_WC_; }  ///< of begin()
  double range() const noexcept { return range_; }
  int columns() const noexcept { return columns_; }
  int rows() const noexcept { return rows_; }
  /// Rays in rows of equal elevation, the lowest first; in each row by increasing azimuth.
  const std::vector<Vector3>& directions_C() const noexcept { return directions_; }
  const std::vector<double>& distances() const noexcept { return distances_; }  ///< infinite: nothing in range [m]
  const std::vector<int>& ids() const noexcept { return ids_; }                 ///< or kNothing

 private:
  struct Window {
    double from, to;  // [rad]
  };

  int columns_, rows_;
  double range_, azimuth_, elevation_;  // half angles
  std::vector<Vector3> directions_;
  std::vector<double> distances_;
  std::vector<int> ids_;
  Isometry X_WC_ = Isometry::Identity();
};

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

  /// True if look() takes a frame of this sensor at step k.
  bool is_due(int sensor, long k) const noexcept { return k % at(sensor).every == 0; }
  /// True if the last look() took a frame of this sensor; interval(): time between two frames [s].
  bool due(int sensor) const noexcept { return at(sensor).due; }
  double interval(int sensor) const noexcept { return static_cast<double>(at(sensor).every) * dt_; }
  /// Number of rays of the sensor's latest frame that ended on the object; and over all sensors.
  int rays_on(int sensor, std::size_t object) const noexcept { return at(sensor).hits[object]; }
  int rays_on(std::size_t object) const noexcept;
  /// The sensor's latest frame.
  const RayView& view(int sensor) const noexcept { return at(sensor).view; }
  /// Turns the sensor's head towards a direction, as far as it gets in a control period. Anything but numbers is
  /// ignored.
  void turn(int sensor, const Gaze& wanted) noexcept;
  /// Present angles of its head.
  const Gaze& gaze(int sensor) const noexcept { return at(sensor).gaze; }
  /// Position of the sensor in its latest frame.
  const Vector3& place_W(int sensor) const noexcept { return at(sensor).p_W; }

 private:
  struct One {
    const MountedSensor* mounted;
    RayView view;
    long every;  // control periods between frames
    bool due = false;
    Gaze gaze{};
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
