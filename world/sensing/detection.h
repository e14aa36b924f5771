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

/// Decides which objects are visible (DetectionRule), by the true poses. With SeenBy::kSensors an object is in range at
/// a step, and visible only then, if two rays or more of the robot's sensors end on it, in the latest frame of each
/// (sensor_frames.h). Otherwise it is in range if all of these conditions hold:
/// - its surface is within `range` of the sensor,
/// - the direction from the sensor to its nearest point, or to its origin, is within half of `field_of_view` of `axis`,
/// - with `occlusion`, the line of sight to one of these two points is clear of all other objects and of the robot's
///   shapes (except shapes that contain the sensor).
/// This rule measures distances to convex hulls by their bounding spheres.
class Detection {
 public:
  /// `model` is needed for a sensor on the hand, for occlusion by the robot, and for the robot's own sensors.
  Detection(const DetectionRule& rule, const World& world, const DisturbanceStreams& streams, double control_period,
            std::shared_ptr<const RobotModel> model = nullptr);

  bool on() const noexcept { return on_; }
  /// Takes the true states of robot and objects at step k = 0, 1, 2, ... (each once, in order) and clears `visible` of
  /// objects that are not visible. `q` may be empty if it does not matter (sensor on the base, no occlusion).
  void update(long k, const Vector3& base, const VectorX& q, std::vector<ObjectState>& objects);

  /// Position of the sensor at the last update() or place(); with the robot's sensors, of the one nearest to p_W.
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
  std::optional<Kinematics> kinematics_;  // only if the arm matters
  std::optional<SensorFrames> frames_;    // with SeenBy::kSensors
  long steps_, missed_span_;
  bool on_;
  bool first_ = true;           // the next update is of step 0
  std::vector<long> in_range_;  // number of consecutive steps in range; constant once found, except with `lost`
  std::vector<char> found_;
  Vector3 sensor_W_ = Vector3::Zero();
  Vector3 axis_W_ = Vector3::UnitX();
};

}  // namespace moma
