#include <algorithm>

#include "world/scenario/family.h"
#include "world/scenario/objects.h"

namespace moma {
namespace {

/// Goals one after the other, with solids along the straight ways between them.
struct Sequence {
  using Uniform = Distribution::Uniform;
  Placement placement{.distance = Distribution(Uniform{0.5, 2.5})};
  Count goals{Distribution::Fixed{4.0}};
  bool on_the_move = false;
  Count objects{Uniform{0.0, 8.0}};
  Distribution lateral{Distribution::Normal{0.0, 0.6}};  ///< [m]
  ObjectMix mix;
};

constexpr void describe(auto& v, Of<Sequence>) {
  using T = Sequence;
  v.inlined(&T::placement);
  v.member("goals", &T::goals, in_range({2, 100}, "", "number of goals"));
  v.member("on_the_move", &T::on_the_move, {.text = "the hand passes through all goals but the last"});
  v.member("objects", &T::objects, in_range({0, 1000}, "", "number of solids"));
  v.member("lateral", &T::lateral, quantity("m", "position of a solid to the left of the way between two goals"));
  v.inlined(&T::mix);
}

bool build(const Sequence& p, SceneBuilder& builder, World& world) {
  if (!builder.place_robot(p.placement, world)) return false;
  Draws number = builder.draws(Stream::kObjects);
  const int goals = p.goals.sample(number);
  for (int i = 1; i < goals; ++i)
    if (!builder.place_further(p.placement, world)) return false;
  world.goal.stop = !p.on_the_move;
  for (WorldGoal& goal : world.further) goal.stop = !p.on_the_move;
  world.further.back().stop = true;
  const ObjectPlacing placing{.count = p.objects.sample(number),
                              .tries = 100,
                              .name = "object",
                              .drawn_again = "an object not clear of start and goals",
                              .out_of_tries = "objects: no place clear of start and goals (worlds.clearance)"};
  double along = 0.0;
  return placing.place(builder, world, [&](const ObjectTry& at, WorldObject& object) {
    Draws draws = builder.draws(Stream::kObjects, at.item);
    // The position along the ways is kept over the tries, as in clutter.
    const double again = draws.uniform(0.0, goals);
    if (at.number == 0) along = again;
    const auto leg = static_cast<std::size_t>(along);
    const Vector3 from = leg == 0 ? builder.start_tip() : goal_of(world, leg - 1).X_WG.translation();
    const Vector3 way = goal_of(world, leg).X_WG.translation() - from;
    const double length = std::max(way.head<2>().norm(), 1e-6);
    const Vector2 place = (from + (along - static_cast<double>(leg)) * way).head<2>() +
                          p.lateral.sample(draws) / length * Vector2(-way.y(), way.x());
    p.mix.sample(draws, place.x(), place.y(), object);
    return builder.stands_clear(object, builder.clearance());
  });
}

}  // namespace

FamilyType sequence_family() {
  return family_type<Sequence>("goals one after the other, stopped at or passed through, among solids");
}

}  // namespace moma
