#include "world/sensing/detection.h"

#include <cmath>

#include "controller/model/analytic_distance.h"

namespace moma {

Detection::Detection(const DetectionRule& rule, const World& world, double control_period)
    : rule_(rule),
      steps_(delay_steps(rule.detection, control_period)),
      on_(std::isfinite(rule.range) || steps_ > 0),
      in_range_(world.objects.size(), 0) {
  shapes_.reserve(world.objects.size());
  for (const WorldObject& object : world.objects) shapes_.push_back(object.shape);
}

void Detection::update(const Vector3& base, std::vector<ObjectState>& objects) {
  const double c = std::cos(base.z()), s = std::sin(base.z());
  const auto& p = rule_.sensor;
  const Vector3 sensor_W(base.x() + c * p[0] - s * p[1], base.y() + s * p[0] + c * p[1], p[2]);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    // In range at the first step counts as 1: found when `detection` has passed since.
    if (in_range_[i] <= steps_) {
      const Isometry& X_WO = objects[i].X_WO;
      const Vector3 sensor_O = X_WO.linear().transpose() * (sensor_W - X_WO.translation());
      const bool near = point_distance(shapes_[i], sensor_O).d <= rule_.range;
      in_range_[i] = !near ? 0 : first_ && rule_.known_at_start ? steps_ + 1 : in_range_[i] + 1;
    }
    if (in_range_[i] <= steps_) objects[i].visible = false;
  }
  first_ = false;
}

}  // namespace moma
