#include "world/scenario/family.h"
#include "world/scenario/objects.h"
#include "world/scenario/walk.h"

namespace moma {
namespace {

/// Solids along the straight way from start to goal, clear of start and witness.
struct Clutter {
  using Uniform = Distribution::Uniform;
  Placement placement;
  Count objects{Uniform{5.0, 15.0}};
  Distribution along{Uniform{0.0, 1.0}};                 ///< [1]
  Distribution lateral{Distribution::Normal{0.0, 0.6}};  ///< [m]
  ObjectMix mix;
};

constexpr void describe(auto& v, Of<Clutter>) {
  using T = Clutter;
  v.inlined(&T::placement);
  v.member("objects", &T::objects, in_range({0, 1000}, "", "number of solids"));
  v.member("along", &T::along,
           quantity("1", "position of a solid along the way, as a share of the way from start to goal"));
  v.member("lateral", &T::lateral, quantity("m", "position of a solid to the left of the way"));
  v.inlined(&T::mix);
}

bool build(const Clutter& p, SceneBuilder& builder, World& world) {
  if (!builder.place_robot(p.placement, world)) return false;
  const Way way = straight_way(builder, world);
  Draws number = builder.draws(Stream::kObjects);
  const ObjectPlacing placing{.count = p.objects.sample(number),
                              .tries = 100,
                              .name = "object",
                              .drawn_again = "an object not clear of start and goal",
                              .out_of_tries = "objects: no place clear of start and goal (worlds.clearance)"};
  double along = 0.0;
  return placing.place(builder, world, [&](const ObjectTry& at, WorldObject& object) {
    Draws draws = builder.draws(Stream::kObjects, at.item);
    // The position along the way is kept over the tries; otherwise objects that do not fit near start and goal would
    // crowd in the middle.
    const double again = p.along.sample(draws);
    if (at.number == 0) along = again;
    const Vector3 place = way.from + along * way.length * way.forward + p.lateral.sample(draws) * way.left();
    p.mix.sample(draws, place.x(), place.y(), object);
    return builder.stands_clear(object, builder.clearance());
  });
}

}  // namespace

FamilyType clutter_family() {
  return family_type<Clutter>("solids along the straight way from start to goal, clear of both");
}

}  // namespace moma
