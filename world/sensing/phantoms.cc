#include "world/sensing/phantoms.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace moma {

Phantoms::Phantoms(const FalseDetections& rule, const DisturbanceStreams& streams, double control_period)
    : rule_(rule),
      streams_(streams),
      span_(std::max(1L, delay_steps(rule.duration, control_period))),
      states_(static_cast<std::size_t>(rule.count)) {}

std::vector<ObjectShape> Phantoms::shapes(const World& world) const {
  std::vector<ObjectShape> out;
  for (std::size_t i = 0; i < count(); ++i) {
    ObjectShape& shape = out.emplace_back();
    shape.name = "phantom" + std::to_string(i);
    while (std::any_of(world.objects.begin(), world.objects.end(),
                       [&](const WorldObject& object) { return object.name == shape.name; }))
      shape.name += "'";
    shape.shape.kind = ShapeKind::kSphere;
    shape.shape.size = Vector3(rule_.radius, 0.0, 0.0);
  }
  return out;
}

void Phantoms::append(long k, const Vector3& base, std::vector<ObjectState>& objects) {
  if (k % span_ == 0) {
    for (std::size_t i = 0; i < states_.size(); ++i) {
      Draws draws = streams_.sensing(DisturbanceSource::kPhantom, k / span_, i);
      ObjectState& state = states_[i];
      state = {};
      state.visible = draws.uniform() < rule_.probability;
      if (!state.visible) continue;
      const double low = std::min(rule_.nearest, rule_.furthest), high = std::max(rule_.nearest, rule_.furthest);
      const double distance = draws.uniform(low, high), angle = draws.uniform(-std::numbers::pi, std::numbers::pi);
      state.X_WO.translation() = Vector3(base.x() + distance * std::cos(angle), base.y() + distance * std::sin(angle),
                                         draws.uniform(0.0, rule_.height));
    }
  }
  objects.insert(objects.end(), states_.begin(), states_.end());
}

}  // namespace moma
