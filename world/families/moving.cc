#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "world/scenario/family.h"
#include "world/scenario/objects.h"
#include "world/scenario/walk.h"

namespace moma {
namespace {

constexpr Range kPart{0.0, 1.0};

/// Solids that move through the robot's way. Some cross it in a straight line at about the time of the robot's passage,
/// some come along it from the far side, some circle beside it or around the goal, and people walk about. Their whole
/// paths over `horizon` are clear of start and witness: nothing hits a robot that waits, and a robot that has arrived
/// can stay.
struct Moving {
  using Uniform = Distribution::Uniform;
  Placement placement{.distance = Distribution(Uniform{2.0, 4.0})};
  Count objects{Uniform{1.0, 4.0}};
  double crossing = 0.5;                        ///< [1]
  Distribution speed{Uniform{0.1, 0.5}};        ///< [m/s]
  Distribution robot_speed{Uniform{0.3, 0.6}};  ///< [m/s]
  Distribution along{Uniform{0.2, 0.8}};        ///< [1]
  Distribution angle{Uniform{-0.5, 0.5}};       ///< [rad]
  Distribution offset{Uniform{0.3, 1.2}};       ///< [m]
  double horizon = 60.0;                        ///< [s]
  ObjectMix mix{.standing = 1.0, .height = Distribution(Uniform{0.3, 1.2})};
  double orbit = 0.0;                            ///< [1]
  Distribution orbit_radius{Uniform{0.5, 2.0}};  ///< [m]
  double orbit_goal = 0.5;                       ///< [1]
  double walk = 0.0;                             ///< [1]
  Walk walker;
};

constexpr void describe(auto& v, Of<Moving>) {
  using T = Moving;
  v.inlined(&T::placement);
  v.member("objects", &T::objects, in_range({0, 1000}, "", "number of moving solids and people"));
  v.member("crossing", &T::crossing,
           in_range(kPart, "1", "share of crossing objects among those on straight lines; the others approach"));
  v.member("speed", &T::speed, non_negative("m/s", "speed of objects that do not walk"));
  v.member("robot_speed", &T::robot_speed,
           positive("m/s", "nominal speed of the robot, which determines the time of a meeting"));
  v.member("along", &T::along, quantity("1", "meeting point, as a share of the way"));
  v.member("angle", &T::angle,
           quantity("rad", "deviation from a right angle to the way (crossing) or from the way (approaching)"));
  v.member("offset", &T::offset, quantity("m", "distance from the way, of approaching objects and of circles"));
  v.member("horizon", &T::horizon,
           in_range({0.0, 3600.0, true, false}, "s", "time for which start and witness are clear"));
  v.inlined(&T::mix);
  // Written only if present: worlds stored before these options existed keep their keys.
  v.written_where(
      [](const T& moving) { return moving.orbit > 0.0; },
      [](auto& orbits) {
        orbits.member("orbit", &T::orbit, in_range(kPart, "1", "share of objects that move in circles"));
        orbits.member("orbit_radius", &T::orbit_radius, in_range({0.05, 1000.0}, "m", "radius of the circles"));
        orbits.member("orbit_goal", &T::orbit_goal,
                      in_range(kPart, "1", "share of circles around the goal; the others are beside the way"));
      });
  v.written_where([](const T& moving) { return moving.walk > 0.0; },
                  [](auto& walks) {
                    walks.member("walk", &T::walk, in_range(kPart, "1", "share of objects that walk"));
                    walks.inlined(&T::walker);
                  });
}

void check(const Moving& p, const config::MapReader& in) {
  in.check(p.orbit + p.walk <= 1.0 + 1e-12, "orbit", "orbit and walk are parts of the objects: at most 1 together");
}

/// Draws an object that crosses or approaches. False if its path is not clear.
bool straight(const Moving& p, SceneBuilder& builder, const Way& way, std::uint64_t item, WorldObject& object) {
  Draws draws = builder.draws(Stream::kMotion, item);
  const bool crosses = draws.uniform() < p.crossing;
  const double speed = p.speed.sample(draws);
  const double robot_speed = p.robot_speed.sample(draws);
  const double along = p.along.sample(draws);
  const double angle = p.angle.sample(draws);
  const double offset = p.offset.sample(draws);
  const double side = draws.uniform() < 0.5 ? -1.0 : 1.0;

  // Meeting point of object and robot, if the robot goes straight at its nominal speed.
  const double meeting_time = along * way.length / robot_speed;
  Vector3 meeting = way.from + along * way.length * way.forward;
  Vector3 heading = side * way.left();
  if (!crosses) {
    heading = -way.forward;
    meeting += side * offset * way.left();
  }
  const Vector3 direction = Eigen::AngleAxisd(angle, Vector3::UnitZ()) * heading;
  const Vector3 begin = meeting - speed * meeting_time * direction;

  Draws solid = builder.draws(Stream::kObjects, item);
  p.mix.sample(solid, begin.x(), begin.y(), object);
  LinearMotion motion;
  motion.V_W.tail<3>() = speed * direction;
  object.motion = motion;
  return builder.clear_for(object, speed, p.horizon, builder.clearance());
}

/// Draws an object that moves in a circle and turns with it. False if its path is not clear.
bool circle(const Moving& p, SceneBuilder& builder, const World& world, const Way& way, bool around_goal,
            std::uint64_t item, WorldObject& object) {
  Draws draws = builder.draws(Stream::kMotion, item);
  const double speed = p.speed.sample(draws);
  const double radius = p.orbit_radius.sample(draws);
  const double along = p.along.sample(draws);
  const double offset = p.offset.sample(draws);
  const double side = draws.uniform() < 0.5 ? -1.0 : 1.0;
  const double sense = draws.uniform() < 0.5 ? -1.0 : 1.0;
  const double phase = draws.uniform(-std::numbers::pi, std::numbers::pi);

  Vector3 center = way.from + along * way.length * way.forward + side * offset * way.left();
  if (around_goal) center = world.goal.X_WG.translation();
  Draws solid = builder.draws(Stream::kObjects, item);
  p.mix.sample(solid, center.x() + radius * std::cos(phase), center.y() + radius * std::sin(phase), object);
  center.z() = object.X_WO.translation().z();
  const double rate = speed / radius;
  object.motion = CircleMotion{center, Vector3::UnitZ(), sense * rate};
  // Its outermost point is the fastest; one revolution covers all poses.
  const double fastest = rate * (radius + bounding_radius(object.shape));
  const double once = rate > 0.0 ? std::min(p.horizon, 2.0 * std::numbers::pi / rate) : 0.0;
  const double between = fastest * SceneBuilder::kTimeStep;
  return builder.clear_for(object, fastest, once, builder.clearance() + between);
}

bool build(const Moving& p, SceneBuilder& builder, World& world) {
  if (!builder.place_robot(p.placement, world)) return false;
  Draws number = builder.draws(Stream::kObjects);
  const int count = p.objects.sample(number);
  const Way way = straight_way(builder, world);
  // The kind of motion is kept over an object's tries; otherwise kinds that rarely fit would be rarer than requested.
  Draws kinds = builder.draws(Stream::kMotion, 0);
  double kind = 0.0;
  bool around_goal = false, walks = false;
  const ObjectPlacing placing{.count = count,
                              .tries = 200,
                              .name = "object",
                              .drawn_again = "a path not clear of start and goal",
                              .out_of_tries = "objects: no path clear of start and goal (worlds.clearance)"};
  return placing.place(builder, world, [&](const ObjectTry& at, WorldObject& object) {
    if (at.number == 0) {
      kind = kinds.uniform();
      around_goal = kinds.uniform() < p.orbit_goal;
      walks = kind >= 1.0 - p.walk;
      if (walks) object.name = "walker" + std::to_string(world.objects.size() + 1);
    }
    if (walks) return p.walker.sample(builder, way, p.mix, p.horizon, at.item, object);
    if (kind < p.orbit) return circle(p, builder, world, way, around_goal, at.item, object);
    return straight(p, builder, way, at.item, object);
  });
}

}  // namespace

FamilyType moving_family() {
  return family_type<Moving>(
      "solids that cross the way or come along it, that circle, and people who walk; never through start or witness");
}

}  // namespace moma
