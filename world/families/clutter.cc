#include <cmath>

#include "world/scenario/family.h"
#include "world/scenario/object_mix.h"

namespace moma {
namespace {

constexpr int kObjectTries = 100;

/// Solids along the straight way from start to goal, clear of start and witness.
struct Clutter {
  using Uniform = Distribution::Uniform;
  Placement placement;
  Count objects{Uniform{5.0, 15.0}};
  Distribution along{Uniform{0.0, 1.0}};                 ///< [1]
  Distribution lateral{Distribution::Normal{0.0, 0.6}};  ///< [m]
  ObjectMix mix;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<Clutter>) {
  using T = Clutter;
  v.inlined(&T::placement);
  v.member("objects", &T::objects, {.range = {0, 1000}, .text = "number of solids"});
  v.member("along", &T::along, {.unit = "1", .text = "where a solid is: part of the way from start to goal"});
  v.member("lateral", &T::lateral, {.unit = "m", .text = "and so far to the left of the way"});
  v.inlined(&T::mix);
}

bool build(const Clutter& p, SceneBuilder& builder, World& world) {
  if (!builder.place_robot(p.placement, world)) return false;
  // A mobile robot leaves with its base, a fixed one with its tool.
  const Vector3 from =
      builder.mobile() ? Vector3(world.start.base.x(), world.start.base.y(), 0.0) : builder.start_tip();
  Vector3 way = world.goal.X_WG.translation() - from;
  way.z() = 0.0;
  const double length = way.norm();
  const Vector3 forward = length > 1e-6 ? Vector3(way / length) : Vector3::UnitX();
  const Vector3 left(-forward.y(), forward.x(), 0.0);

  Draws number = builder.draws(Stream::kObjects);
  const int count = p.objects.sample(number);
  for (int i = 0; i < count; ++i) {
    WorldObject object;
    object.name = "object" + std::to_string(i + 1);
    bool placed = false;
    double along = 0.0;
    for (int k = 0; k < kObjectTries && !placed; ++k) {
      // Item 0 is the number of objects; each object's tries have items of their own.
      Draws draws = builder.draws(Stream::kObjects, 1 + static_cast<std::uint64_t>(i * kObjectTries + k));
      // The place along the way is kept over the tries: else all that does not fit beside start and goal would end
      // up in the middle.
      const double again = p.along.sample(draws);
      if (k == 0) along = again;
      const Vector3 at = from + along * length * forward + p.lateral.sample(draws) * left;
      p.mix.sample(draws, at.x(), at.y(), object);
      placed = builder.stands_clear(object, builder.clearance());
      if (!placed) builder.drawn_again("an object not clear of start and goal");
    }
    if (!placed) return builder.reject("objects: no place clear of start and goal (worlds.clearance)");
    world.objects.push_back(std::move(object));
  }
  return true;
}

}  // namespace

FamilyType clutter_family() {
  return family_type<Clutter>("solids along the straight way from start to goal, clear of both");
}

}  // namespace moma
