#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "controller/model/kinematics.h"
#include "world/sensing/disturbances.h"
#include "world/sensing/streams.h"
#include "world/world.h"

namespace moma {

/// Which objects are seen (DetectionRule), by the true poses. An object is in range at a step where all of it holds:
/// - its surface is within `range` of the sensor,
/// - the direction from the sensor to its nearest point, or to its origin, is within half of `field_of_view` of `axis`,
/// - with `occlusion`, the line of sight to one of these two points keeps clear of all other objects and of the robot's
///   shapes (those in which the sensor itself lies hide nothing).
/// Distances to convex hulls are those to the spheres about them.
class Detection {
 public:
  /// With `model` the sensor can be on the hand and the robot can hide what is behind it.
  Detection(const DetectionRule& rule, const World& world, const DisturbanceStreams& streams, double control_period,
            std::shared_ptr<const RobotModel> model = nullptr);

  bool on() const noexcept { return on_; }
  /// Takes the true state of the robot and the true states of objects at step k = 0, 1, 2, ... (each once, in order)
  /// and sets `visible` of those that are not seen to false. `q` may be empty where it does not matter (sensor on the
  /// base, no occlusion).
  void update(long k, const Vector3& base, const VectorX& q, std::vector<ObjectState>& objects);

  /// Where the sensor was at the last update() or place().
  const Vector3& sensor_W() const noexcept { return sensor_W_; }
  void place(const Vector3& base, const VectorX& q);

 private:
  bool in_range(std::size_t i, const std::vector<ObjectState>& objects);
  bool hidden(std::size_t i, const Vector3& point_W, const std::vector<ObjectState>& objects);

  DetectionRule rule_;
  DisturbanceStreams streams_;
  std::vector<Shape> shapes_;
  std::shared_ptr<const RobotModel> model_;
  std::optional<Kinematics> kinematics_;  // where the arm matters
  long steps_, missed_span_;
  bool on_;
  bool first_ = true;           // the next update is of step 0
  std::vector<long> in_range_;  // consecutive steps; once found it no longer changes, but with `lost`
  std::vector<char> found_;
  Vector3 sensor_W_ = Vector3::Zero();
  Vector3 axis_W_ = Vector3::UnitX();
};

}  // namespace moma
