#include <cmath>

#include "world/scenario/family.h"
#include "world/scenario/objects.h"

namespace moma {
namespace {

/// A goal on a conveyor: it moves to and fro on a line at constant speed, with objects between the line and the start.
/// For mobile bases. Solvable by construction: the line has the driving direction of the witness's base, so that a
/// robot at the goal follows it by driving straight, and all objects are clear of the witness along the whole line.
struct Conveyor {
  using Uniform = Distribution::Uniform;
  Placement placement{.distance = Distribution(Uniform{2.0, 4.0}), .tip_height = 0.3};
  Distribution speed{Uniform{0.05, 0.2}};  ///< [m/s]
  Distribution length{Uniform{0.8, 2.0}};  ///< [m]
  double duration = 120.0;                 ///< [s]
  Count objects{Uniform{3.0, 8.0}};
  Distribution along{Uniform{0.2, 0.9}};     ///< [1]
  Distribution lateral{Uniform{-1.0, 1.0}};  ///< [m]
  ObjectMix mix{.standing = 0.8};
};

constexpr void describe(auto& v, Of<Conveyor>) {
  using T = Conveyor;
  v.inlined(&T::placement);
  v.member("speed", &T::speed, positive("m/s", "speed of the goal"));
  v.member("length", &T::length, positive("m", "length of the goal's line"));
  v.member("duration", &T::duration,
           in_range({0.0, 3600.0, true, false}, "s", "time of motion, after which the goal rests"));
  v.member("objects", &T::objects, in_range({0, 1000}, "", "number of solids beside the way"));
  v.member("along", &T::along,
           quantity("1", "position of a solid along the way, as a share of the way from start to goal"));
  v.member("lateral", &T::lateral, quantity("m", "position of a solid to the left of the way"));
  v.inlined(&T::mix);
}

bool build(const Conveyor& p, SceneBuilder& builder, World& world) {
  if (!builder.mobile()) return builder.reject("conveyor: a fixed base cannot drive along it");
  if (!builder.place_robot(p.placement, world)) return false;
  Draws draws = builder.draws(Stream::kMotion);
  const double speed = p.speed.sample(draws);
  const double length = p.length.sample(draws);
  const double sense = draws.uniform() < 0.5 ? -1.0 : 1.0;
  Draws number = builder.draws(Stream::kObjects);
  const int count = p.objects.sample(number);
  if (speed > builder.model().base.max_linear) return builder.reject("conveyor: too fast to follow (speed)");

  const double heading = world.witness.base.z();
  const Vector3 forward = sense * Vector3(std::cos(heading), std::sin(heading), 0.0);
  const Vector3 from = world.goal.X_WG.translation();
  const double leg = length / speed;
  world.goal.motion = to_and_fro(from, from + length * forward, leg, p.duration);

  const Vector3 way(from.x(), from.y(), 0.0);  // the start is the origin
  const Vector3 left = way.norm() > 1e-6 ? Vector3(Vector3(-way.y(), way.x(), 0.0).normalized()) : Vector3::UnitY();
  const ObjectPlacing placing{
      .count = count,
      .tries = 200,
      .name = "object",
      .drawn_again = "an object not clear of start and the goal's way",
      .out_of_tries = "conveyor: no place for an object clear of the goal's way (worlds.clearance)"};
  return placing.place(builder, world, [&](const ObjectTry& at, WorldObject& object) {
    Draws own = builder.draws(Stream::kObjects, at.item);
    const double along = p.along.sample(own);
    const double lateral = p.lateral.sample(own);
    const Vector3 place = along * way + lateral * left;
    p.mix.sample(own, place.x(), place.y(), object);
    // In the frame of the moving witness, objects at rest move towards it.
    WorldObject passing = object;
    LinearMotion relative;
    relative.V_W.tail<3>() = -speed * forward;
    passing.motion = relative;
    return builder.stands_clear(object, builder.clearance()) &&
           builder.clear_for(passing, speed, leg, builder.clearance());
  });
}

}  // namespace

FamilyType conveyor_family() {
  return family_type<Conveyor>("a goal that moves to and fro on a line behind obstacles; mobile bases");
}

}  // namespace moma
