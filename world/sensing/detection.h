#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/sensor_frames.h"
#include "world/sensing/disturbances.h"
#include "world/sensing/streams.h"
#include "world/world.h"

namespace moma {

/// Which objects are seen (DetectionRule), by the true poses. With SeenBy::kSensors an object is in range at a step
/// where two rays or more of the robot's sensors, in the latest frame of each, end on it, and it is seen only then
/// (sensor_frames.h). Else it is in range where all of this holds:
/// - its surface is within `range` of the sensor,
/// - the direction from the sensor to its nearest point, or to its origin, is within half of `field_of_view` of `axis`,
/// - with `occlusion`, the line of sight to one of these two points keeps clear of all other objects and of the robot's
///   shapes (those in which the sensor itself lies hide nothing).
/// Of this rule, distances to convex hulls are those to the spheres about them.
class Detection {
 public:
  /// With `model` the sensor can be on the hand, the robot can hide what is behind it and has sensors of its own.
  Detection(const DetectionRule& rule, const World& world, const DisturbanceStreams& streams, double control_period,
            std::shared_ptr<const RobotModel> model = nullptr);

  bool on() const noexcept { return on_; }
  /// Takes the true state of the robot and the true states of objects at step k = 0, 1, 2, ... (each once, in order)
  /// and sets `visible` of those that are not seen to false. `q` may be empty where it does not matter (sensor on the
  /// base, no occlusion).
  void update(long k, const Vector3& base, const VectorX& q, std::vector<ObjectState>& objects);

  /// Where the sensor was at the last update() or place(); of the robot's sensors, that nearest to p_W.
  const Vector3& sensor_W(const Vector3& p_W) const noexcept;
  void place(const Vector3& base, const VectorX& q);

 private:
  bool by_sensors() const noexcept { return rule_.seen_by == SeenBy::kSensors; }
  bool in_range(std::size_t i, const std::vector<ObjectState>& objects);
  bool near(std::size_t i, const std::vector<ObjectState>& objects);
  bool hidden(std::size_t i, const Vector3& point_W, const std::vector<ObjectState>& objects);

  DetectionRule rule_;
  DisturbanceStreams streams_;
  std::vector<Shape> shapes_;
  std::shared_ptr<const RobotModel> model_;
  std::optional<Kinematics> kinematics_;  // where the arm matters
  std::optional<SensorFrames> frames_;    // with SeenBy::kSensors
  long steps_, missed_span_;
  bool on_;
  bool first_ = true;           // the next update is of step 0
  std::vector<long> in_range_;  // consecutive steps; once found it no longer changes, but with `lost`
  std::vector<char> found_;
  Vector3 sensor_W_ = Vector3::Zero();
  Vector3 axis_W_ = Vector3::UnitX();
};

}  // namespace moma
