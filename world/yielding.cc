#include "world/yielding.h"

#include <algorithm>
#include <cstddef>

namespace moma {

Yielding::Yielding(const World& world, double period) : world_(world), period_(period), paces_(world.objects.size()) {
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    if (!gives_way(world.objects[i])) continue;
    givers_.push_back({.object = static_cast<int>(i)});
    range_ = std::max(range_, world.objects[i].yields.distance);
  }
}

VectorX Yielding::times(double t) const {
  VectorX out(static_cast<Eigen::Index>(givers_.size()));
  for (std::size_t i = 0; i < givers_.size(); ++i)
    out[static_cast<Eigen::Index>(i)] = paces_[static_cast<std::size_t>(givers_[i].object)].time(t);
  return out;
}

void Yielding::decide(double t, const Kinematics& kinematics, Proximity& proximity,
                      std::span<const ObjectState> states) {
  const std::span<const ProximityPair> near = proximity.query(kinematics, states, {.object = range_});
  for (Giver& giver : givers_) {
    const auto i = static_cast<std::size_t>(giver.object);
    const WorldObject& object = world_.objects[i];
    Pace& pace = paces_[i];
    pace = {t, pace.time(t), giver.direction};
    if (giver.direction < 0.0 && pace.at <= 0.0) pace.rate = giver.direction = 1.0;
    const MovingPose now = place(object, pace, t);
    const Vector3 course = now.V_W.tail<3>().normalized();  // 0 if it pauses
    const bool blocked = std::ranges::any_of(near, [&](const ProximityPair& pair) {
      if (pair.second != giver.object || pair.distance.d >= object.yields.distance) return false;
      const Vector3 to = pair.distance.p_first_W - now.X.translation();
      const double ahead = to.dot(course);
      const double beside = (to - ahead * course).head<2>().norm();
      const double half_width = (pair.distance.p_second_W - now.X.translation()).head<2>().norm();
      return ahead > 0.0 && beside < half_width + object.yields.side;
    });
    giver.waited = blocked ? giver.waited + period_ : 0.0;
    if (!blocked) continue;
    pace.rate = 0.0;
    if (giver.waited < object.yields.patience) continue;
    giver.direction = -giver.direction;
    giver.waited = 0.0;
  }
}

}  // namespace moma
