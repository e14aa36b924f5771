#include <cmath>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"
#include "world/scenario/objects.h"

namespace moma {
namespace {

/// Two walls along the way, with start, goal and objects between them. For mobile bases.
struct Corridor {
  using Uniform = Distribution::Uniform;
  Placement placement{.distance = Distribution(Uniform{2.0, 4.0})};
  Distribution width{Uniform{1.3, 2.2}};        ///< [m]
  Distribution offset{Uniform{-0.2, 0.2}};      ///< [m]
  Distribution wall_height{Uniform{0.8, 2.0}};  ///< [m]
  double beyond = 1.0;                          ///< [m]
  double thickness = 0.1;                       ///< [m]
  Count objects{Uniform{0.0, 2.0}};
  ObjectMix mix{.standing = 1.0};
};

constexpr void describe(auto& v, Of<Corridor>) {
  using T = Corridor;
  v.inlined(&T::placement);
  v.member("width", &T::width, positive("m", "distance between the walls"));
  v.member("offset", &T::offset, quantity("m", "distance of the corridor's middle from the way"));
  v.member("wall_height", &T::wall_height, positive("m", "height of the walls"));
  v.member("beyond", &T::beyond, non_negative("m", "length of the walls before the start and behind the goal"));
  v.member("thickness", &T::thickness, positive("m", "thickness of the walls"));
  v.member("objects", &T::objects, in_range({0, 100}, "", "number of solids in the corridor"));
  v.inlined(&T::mix);
}

bool build(const Corridor& p, SceneBuilder& builder, World& world) {
  if (!builder.mobile()) return builder.reject("corridor: a fixed base cannot drive along it");
  if (!builder.place_robot(p.placement, world)) return false;
  Draws draws = builder.draws(Stream::kObjects);
  const double width = p.width.sample(draws);
  const double offset = p.offset.sample(draws);
  const double height = p.wall_height.sample(draws);
  const int count = p.objects.sample(draws);

  const Vector3 way(world.witness.base.x(), world.witness.base.y(), 0.0);  // the start is the origin
  const double length = way.norm() + 2.0 * p.beyond;
  FurnitureFrame frame;  // on the corridor's middle line, before the start
  frame.yaw = std::atan2(way.y(), way.x());
  frame.origin = frame.point(-p.beyond, offset, 0.0);
  std::vector<WorldObject> boxes;
  add_left_and_right(boxes, frame, "wall", {0.5 * length, 0.5 * (width + p.thickness), 0.5 * height},
                     {length, p.thickness, height});
  for (const Vector3& tip : {builder.start_tip(), Vector3(world.goal.X_WG.translation())})
    if (std::abs(frame.left().dot(tip - frame.origin)) > 0.5 * width)
      return builder.reject("corridor: start or goal outside its walls");
  if (!add_furniture(builder, std::move(boxes), "corridor:", world)) return false;

  const ObjectPlacing placing{
      .count = count,
      .tries = 100,
      .name = "object",
      .drawn_again = "an object not clear of start and goal",
      .out_of_tries = "corridor: no place for an object clear of start and goal (worlds.clearance)"};
  return placing.place(builder, world, [&](const ObjectTry& at, WorldObject& object) {
    Draws own = builder.draws(Stream::kObjects, at.item);
    // One after the other: the order of a call's arguments is the compiler's.
    const double across = own.uniform(-0.5, 0.5) * width;
    const double along = own.uniform(0.0, 1.0) * length;
    const Vector3 place = frame.point(along, across, 0.0);
    p.mix.sample(own, place.x(), place.y(), object);
    return builder.stands_clear(object, builder.clearance());
  });
}

}  // namespace

FamilyType corridor_family() {
  return family_type<Corridor>(
      "two walls along the way, start and goal between them, with things that stand in the corridor; mobile bases");
}

}  // namespace moma
