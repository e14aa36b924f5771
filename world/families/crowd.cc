#include "world/scenario/family.h"
#include "world/scenario/objects.h"
#include "world/scenario/walk.h"

namespace moma {
namespace {

/// Many people who walk around the robot's way; more of them make the family harder. Their whole paths over `horizon`
/// are clear of start and witness: nobody walks into a robot that waits, and a robot that has arrived can stay.
struct Crowd {
  using Uniform = Distribution::Uniform;
  Placement placement{.distance = Distribution(Uniform{2.0, 4.0})};
  Count people{Uniform{5.0, 10.0}};
  double horizon = 60.0;  ///< [s]
  Walk walker{.speed = Distribution(Distribution::Normal{0.8, 0.2}), .margin = 3.0};
};

constexpr void describe(auto& v, Of<Crowd>) {
  using T = Crowd;
  v.inlined(&T::placement);
  v.member("people", &T::people, in_range({0, 200}, "", "number of people who walk"));
  v.member("horizon", &T::horizon,
           in_range({0.0, 3600.0, true, false}, "s", "time for which start and witness are clear"));
  v.inlined(&T::walker);
}

bool build(const Crowd& p, SceneBuilder& builder, World& world) {
  if (!builder.place_robot(p.placement, world)) return false;
  Draws number = builder.draws(Stream::kObjects);
  const int count = p.people.sample(number);
  const Way way = straight_way(builder, world);
  const ObjectMix mix{.standing = 1.0};
  const ObjectPlacing placing{.count = count,
                              .tries = 400,
                              .name = "person",
                              .drawn_again = "a path not clear of start and goal",
                              .out_of_tries = "people: no path clear of start and goal (worlds.clearance)"};
  return placing.place(builder, world, [&](const ObjectTry& at, WorldObject& person) {
    return p.walker.sample(builder, way, mix, p.horizon, at.item, person);
  });
}

}  // namespace

FamilyType crowd_family() {
  return family_type<Crowd>("people who walk around the way, never through start or witness");
}

}  // namespace moma
