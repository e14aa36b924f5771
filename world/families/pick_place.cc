#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"
#include "world/scenario/hand.h"

namespace moma {
namespace {

/// A can or box on a block is carried to another block, among solids. Six goals: before the object, at it (take), above
/// that, above the place, at the place (leave), and back from it.
struct PickPlace {
  using Uniform = Distribution::Uniform;
  Placement placement{.distance = Distribution(Uniform{0.5, 2.5}), .tip_height = 0.3};
  Distribution clearance{Distribution::Fixed{0.02}};  ///< [m]
  double drop = 0.02;                                 ///< [m]
  Distribution lift{Distribution::Fixed{0.12}};       ///< [m]
  double can = 0.5;
  Distribution radius{Uniform{0.02, 0.04}};  ///< [m]
  Distribution length{Uniform{0.08, 0.2}};   ///< [m]
  Distribution block{Uniform{0.25, 0.6}};    ///< [m]
  Distribution turn{Uniform{-0.4, 0.4}};     ///< [rad]
  double upwards = 0.2;                      ///< [1]
  Count objects{Uniform{0.0, 4.0}};
  Distribution lateral{Distribution::Normal{0.0, 0.6}};  ///< [m]
  ObjectMix mix;
};

constexpr void describe(auto& v, Of<PickPlace>) {
  using T = PickPlace;
  v.inlined(&T::placement);
  v.member("clearance", &T::clearance,
           in_range({0.001, 0.2}, "m", "distance between hand and object when it is taken"));
  v.member("drop", &T::drop, in_range({0.001, 0.2}, "m", "height of the object over the block where it is left"));
  v.member("lift", &T::lift,
           in_range({0.05, 1.0}, "m", "distance of the goals beside those at the object and the place"));
  v.member("can", &T::can, in_range({0.0, 1.0}, "1", "share of upright cylinders; the others are boxes"));
  v.member("radius", &T::radius, in_range({0.005, 0.5}, "m", "radius of a can, half the edge of a box"));
  v.member("length", &T::length, in_range({0.01, 2.0}, "m", "height of the object"));
  v.member("block", &T::block, positive("m", "horizontal edge of the blocks"));
  v.member("turn", &T::turn, quantity("rad", "angle between a block and the robot's line to it"));
  v.member("upwards", &T::upwards, in_range({-1.0, 1.0}, "1", "largest sine of the hand's slope at the object"));
  v.member("objects", &T::objects, in_range({0, 1000}, "", "number of solids along the way"));
  v.member("lateral", &T::lateral, quantity("m", "position of a solid to the left of the way"));
  v.inlined(&T::mix);
}

/// A block below `object`, its near edge towards the base of `robot`.
WorldObject block_under(const WorldObject& object, const std::string& name, double height, const Kinematics& robot,
                        const PickPlace& p, Draws& draws) {
  constexpr double kRim = 0.02;  // [m]
  const Vector3 at(object.X_WO.translation().x(), object.X_WO.translation().y(), 0.0);
  const Vector3 way = at - robot.X_WB().translation();
  FurnitureFrame frame{at, std::atan2(way.y(), way.x()) + p.turn.sample(draws)};
  const double depth = p.block.sample(draws), width = p.block.sample(draws);
  const double inner = bounding_radius(object.shape) + kRim;
  const double inset = std::min(inner, 0.5 * depth), aside = std::max(0.0, 0.5 * width - inner);
  return furniture_box(frame, name, {0.5 * depth - inset, draws.uniform(-aside, aside), 0.5 * height},
                       {depth, width, height});
}

bool build(const PickPlace& p, SceneBuilder& builder, World& world) {
  constexpr double kLowest = 0.15;  // of a block's top [m]
  const Vector3 up = Vector3::UnitZ();
  if (!builder.place_robot(p.placement, world)) return false;
  const Hand hand = hand_at_witness(builder, world, "pick-place");
  if (hand.thin.isZero()) return false;
  if (hand.into.z() > p.upwards) return builder.reject("pick-place: the hand points upwards (upwards)");
  Draws draws = builder.draws(Stream::kObjects);
  const double clearance = p.clearance.sample(draws), lift = p.lift.sample(draws);
  const double radius = p.radius.sample(draws), length = p.length.sample(draws);
  const bool can = draws.uniform() < p.can;
  const double along = draws.uniform(-0.25, 0.25) * length;

  WorldObject object;
  object.name = "object";
  object.shape = can ? Shape{ShapeKind::kCylinder, {radius, length, 0.0}, nullptr}
                     : Shape{ShapeKind::kBox, {2.0 * radius, 2.0 * radius, length}, nullptr};
  const Eigen::Quaterniond rotation = rotation_along(up, std::abs(hand.into.z()) < 0.7 ? hand.into : hand.thin);
  if (!bring_to_hand(builder, hand, along * up, rotation, clearance, "pick-place", object)) return false;
  const double from_height = lowest_point(object.shape, object.X_WO);
  if (from_height < kLowest) return builder.reject("pick-place: the object is too low");
  if (!builder.stands_near(object, clearance)) return builder.reject("pick-place: the object not clear of the start");

  // The place: the object stands upright there, too, and so does the hand that holds it.
  const Kinematics at_take = builder.witness();
  const Isometry X_WT = at_take.X_WE(), X_EO = X_WT.inverse() * object.X_WO;
  const Upright upright{X_WT.linear().row(2).transpose(), 0.0};
  if (!builder.place_further(p.placement, world, &upright)) return false;
  const Kinematics at_leave = builder.further();
  const Isometry X_WL = at_leave.X_WE();
  WorldObject left = object;
  left.X_WO = X_WL * X_EO;
  const double to_height = lowest_point(left.shape, left.X_WO) - p.drop;
  if (to_height < kLowest) return builder.reject("pick-place: the place is too low");

  const auto moved = [&](Isometry X, const Vector3& by) {
    X.translation() += by;
    return X;
  };
  const Vector3 back_L = X_WL.linear() * (X_WT.linear().transpose() * (-lift * hand.into));
  const std::array<std::pair<const Kinematics*, Isometry>, 4> beside{
      std::pair(&at_take, moved(X_WT, -lift * hand.into)), std::pair(&at_take, moved(X_WT, lift * up)),
      std::pair(&at_leave, moved(X_WL, lift * up)), std::pair(&at_leave, moved(X_WL, back_L))};
  const RobotModel& model = builder.model();
  const auto robot_clear_of = [&](const WorldObject& solid) {
    const Kinematics& at = builder.further();
    return std::ranges::all_of(model.shapes, [&](const CollisionShape& shape) {
      return shape_distance(shape.shape, at.X_WS(shape), solid.shape, solid.X_WO).d >= clearance;
    });
  };
  std::vector<Kinematics> holding{at_leave};
  world.further.clear();
  std::vector<WorldGoal> goals(beside.size());
  for (std::size_t i = 0; i < beside.size(); ++i) {
    if (!builder.move_arm(p.placement, *beside[i].first, beside[i].second)) return false;
    if ((i == 0 && !robot_clear_of(object)) || (i == 3 && !robot_clear_of(left)))
      return builder.reject("pick-place: the arm beside the object is nearer than the hand at it");
    set_pose(goals[i], builder.further().X_WE());
    if (i == 0) world.witness = {builder.further().base(), builder.further().q()};
    if (i == 1 || i == 2) holding.push_back(builder.further());
  }
  WorldGoal take = world.goal, leave;
  take.take = leave.leave = object.name;
  set_pose(leave, X_WL);
  world.goal = goals[0];
  world.further = {take, goals[1], goals[2], leave, goals[3]};

  // The carried object keeps `clearance` from the robot's other links, and objects keep their distance from it; only
  // its block at the place is nearer, by `drop`.
  const auto clear_of_carried = [&](const Shape& shape, const Isometry& X_W, const Kinematics& at, double distance) {
    return shape_distance(object.shape, at.X_WE() * X_EO, shape, X_W).d > distance;
  };
  for (const Kinematics& at : holding)
    for (const CollisionShape& shape : model.shapes)
      if (model.rigid_root(shape.link) != model.rigid_root(model.tip) &&
          !clear_of_carried(shape.shape, at.X_WS(shape), at, clearance))
        return builder.reject("pick-place: the object would touch the arm");
  const auto clear = [&](const WorldObject& solid, double distance, bool at_place) {
    for (const Kinematics& at : holding)
      if ((at_place || &at != &holding.front()) && !clear_of_carried(solid.shape, solid.X_WO, at, distance))
        return false;
    return true;
  };
  WorldObject from = block_under(object, "from", from_height, at_take, p, draws);
  WorldObject to = block_under(left, "to", to_height, at_leave, p, draws);
  if (!builder.stands_near(from, clearance) || !builder.stands_near(to, clearance) || !clear(from, clearance, true) ||
      !clear(to, clearance, false) || !(shape_distance(object.shape, object.X_WO, to.shape, to.X_WO).d > clearance))
    return builder.reject("pick-place: a block not clear of start (worlds.clearance) and goals (clearance)");
  world.objects = {object, std::move(from), std::move(to)};

  const Vector3 way = X_WL.translation() - X_WT.translation();
  const Vector3 aside = Vector3(-way.y(), way.x(), 0.0).normalized();
  const ObjectPlacing placing{.count = p.objects.sample(draws),
                              .tries = 100,
                              .name = "solid",
                              .drawn_again = "a solid not clear of start and goals",
                              .out_of_tries = "solids: no place clear of start and goals (worlds.clearance)"};
  return placing.place(builder, world, [&](const ObjectTry& at, WorldObject& solid) {
    Draws each = builder.draws(Stream::kObjects, at.item);
    const Vector3 place = X_WT.translation() + each.uniform() * way + p.lateral.sample(each) * aside;
    p.mix.sample(each, place.x(), place.y(), solid);
    return builder.stands_clear(solid, builder.clearance()) && clear(solid, builder.clearance(), true) &&
           shape_distance(object.shape, object.X_WO, solid.shape, solid.X_WO).d > builder.clearance();
  });
}

}  // namespace

FamilyType pick_place_family() {
  return family_type<PickPlace>("an object on a block that is taken, carried among solids and left on another block");
}

}  // namespace moma
