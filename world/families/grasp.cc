#include <cmath>
#include <utility>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"
#include "world/scenario/hand.h"

namespace moma {
namespace {

/// The hand at a can, a handle or a box, as deep as it goes: the object comes straight towards the hand, between the
/// fingers if there is room, until it is `clearance` away. Cans and boxes stand on a post, a handle before a panel.
struct Grasp {
  using Uniform = Distribution::Uniform;
  Placement placement{.tip_height = 0.3};
  Distribution clearance{Distribution::Fixed{0.02}};  ///< [m]
  double can = 1.0;
  double handle = 1.0;
  double box = 1.0;
  Distribution radius{Uniform{0.02, 0.035}};   ///< [m]
  Distribution length{Uniform{0.1, 0.2}};      ///< [m]
  Distribution stand_off{Uniform{0.06, 0.1}};  ///< [m]
  double upright = 0.9;                        ///< [1]
};

constexpr void describe(auto& v, Of<Grasp>) {
  using T = Grasp;
  constexpr Range kWeight = Range::non_negative();
  v.inlined(&T::placement);
  v.member("clearance", &T::clearance, in_range({0.001, 0.2}, "m", "distance between object and hand at the goal"));
  v.member("can", &T::can, in_range(kWeight, "", "weight of upright cylinders, grasped from the side"));
  v.member("handle", &T::handle, in_range(kWeight, "", "weight of bars before a panel, at any attitude"));
  v.member("box", &T::box, in_range(kWeight, "", "weight of boxes, grasped from above"));
  v.member("radius", &T::radius, in_range({0.002, 0.5}, "m", "radius of can and box; a handle has half of it"));
  v.member("length", &T::length, in_range({0.01, 2.0}, "m", "length along the hand's thin side"));
  v.member("stand_off", &T::stand_off, in_range({0.0, 2.0}, "m", "distance between handle and panel"));
  v.member("upright", &T::upright,
           in_range({0.0, 0.999}, "1",
                    "least cosine of the angle between the hand and one that grasps level (can) or from above (box)"));
}

void check(const Grasp& p, const config::MapReader& in) {
  in.check(p.can + p.handle + p.box > 0.0, "can", "one of can, handle, box must be above 0");
}

/// The panel behind a handle, or the post under a can or box.
WorldObject support(const Hand& hand, const WorldObject& object, bool panel, double radius, double stand_off) {
  constexpr double kPanel = 0.3, kThickness = 0.02;  // [m]
  const Vector3& p = object.X_WO.translation();
  if (!panel) {
    const double height = lowest_point(object.shape, object.X_WO);
    return furniture_box({{p.x(), p.y(), 0.0}, 0.0}, "post", {0.0, 0.0, 0.5 * height},
                         {2.0 * radius, 2.0 * radius, height});
  }
  WorldObject out;
  out.name = "panel";
  out.shape = {ShapeKind::kBox, {kThickness, kPanel, kPanel}, nullptr};
  set_pose(out, p + (radius + stand_off + 0.5 * kThickness) * hand.into, rotation_along(hand.thin, hand.into));
  return out;
}

bool build(const Grasp& p, SceneBuilder& builder, World& world) {
  // The object is the same at every try: one that is grasped at few poses is as frequent as its weight says.
  Draws kinds(world.seed, world.index, Stream::kObjects, 0, 1, world.moves.get());
  const double kind = kinds.uniform() * (p.can + p.handle + p.box);
  const bool is_can = kind < p.can, is_handle = !is_can && kind < p.can + p.handle;
  if (!builder.place_robot(p.placement, world)) return false;
  const Hand hand = hand_at_witness(builder, world, "grasp");
  if (hand.thin.isZero()) return false;
  Draws draws = builder.draws(Stream::kObjects);
  const double clearance = p.clearance.sample(draws);
  const double radius = p.radius.sample(draws) * (is_handle ? 0.5 : 1.0);
  const double length = p.length.sample(draws);
  const double stand_off = p.stand_off.sample(draws);
  const double along = draws.uniform(-0.25, 0.25) * length;

  WorldObject object;
  const Vector3 up = Vector3::UnitZ();
  Eigen::Quaterniond rotation = rotation_along(hand.thin, hand.into);
  if (is_handle) {
    object.name = "handle";
    object.shape = {ShapeKind::kCapsule, {radius, length, 0.0}, nullptr};
  } else if (is_can) {
    if (std::abs(hand.thin.z()) < p.upright) return builder.reject("grasp: the hand is not level at a can (upright)");
    object.name = "can";
    object.shape = {ShapeKind::kCylinder, {radius, length, 0.0}, nullptr};
    rotation = rotation_along(up, hand.into);
  } else {
    if (-hand.into.z() < p.upright) return builder.reject("grasp: the hand is not above a box (upright)");
    object.name = "box";
    object.shape = {ShapeKind::kBox, {length, 2.0 * radius, 2.0 * radius}, nullptr};
    rotation = rotation_along(up, hand.thin);
  }
  if (!bring_to_hand(builder, hand, along * hand.thin, rotation, clearance, "grasp", object)) return false;

  WorldObject support_of_it = support(hand, object, is_handle, radius, stand_off);
  if (lowest_point(object.shape, object.X_WO) <= 1e-3 || lowest_point(support_of_it.shape, support_of_it.X_WO) < -1e-9)
    return builder.reject("grasp: the object reaches the floor");
  for (WorldObject* solid : {&object, &support_of_it}) {
    if (!builder.stands_near(*solid, clearance))
      return builder.reject("grasp: " + solid->name + " not clear of start (worlds.clearance) and goal (clearance)");
    world.objects.push_back(std::move(*solid));
  }
  return true;
}

}  // namespace

FamilyType grasp_family() {
  return family_type<Grasp>("the hand at a can, a handle or a box, as near to it as clearance says");
}

}  // namespace moma
