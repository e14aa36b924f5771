#include "world/scenario/family.h"
#include "world/scenario/furniture.h"
#include "world/scenario/objects.h"

namespace moma {
namespace {

/// A table whose top is slightly below the goal, with its near edge towards the robot and objects on it.
struct Table {
  using Uniform = Distribution::Uniform;
  Placement placement{.tip_height = 0.45};
  Distribution above{Uniform{0.06, 0.2}};   ///< [m]
  Distribution inset{Uniform{0.05, 0.35}};  ///< [m]
  Distribution width{Uniform{0.8, 1.6}};    ///< [m]
  Distribution depth{Uniform{0.5, 0.9}};    ///< [m]
  Distribution turn{Uniform{-0.4, 0.4}};    ///< [rad]
  double thickness = 0.04;                  ///< [m]
  Count items{Uniform{0.0, 4.0}};
  ObjectMix items_mix = small_things();
};

constexpr void describe(auto& v, Of<Table>) {
  using T = Table;
  v.inlined(&T::placement);
  v.member("above", &T::above, non_negative("m", "height of the goal above the tabletop"));
  v.member("inset", &T::inset, quantity("m", "distance of the goal behind the near edge"));
  v.member("width", &T::width, positive("m", "width of the table along its near edge"));
  v.member("depth", &T::depth, positive("m", "depth of the table"));
  v.member("turn", &T::turn, quantity("rad", "angle between the table and the robot's line to the goal"));
  v.member("thickness", &T::thickness, positive("m", "thickness of the tabletop"));
  v.member("items", &T::items, in_range({0, 100}, "", "number of objects on the table"));
  v.inlined(&T::items_mix);
}

bool build(const Table& p, SceneBuilder& builder, World& world) {
  if (!builder.place_robot(p.placement, world)) return false;
  Draws draws = builder.draws(Stream::kObjects);
  const double above = p.above.sample(draws);
  const double inset = p.inset.sample(draws);
  const double width = p.width.sample(draws);
  const double depth = p.depth.sample(draws);
  const double turn = p.turn.sample(draws);
  const double sideways = draws.uniform(-0.4, 0.4);
  const int items = p.items.sample(draws);

  const Vector3 goal = world.goal.X_WG.translation();
  const double top = goal.z() - above;
  if (top < 0.3 || top > 1.3) return builder.reject("table: the goal is at no height for a table");
  // F's origin is the middle of the near edge.
  FurnitureFrame frame;
  frame.yaw = heading_to_goal(world) + turn;
  frame.origin = Vector3(goal.x(), goal.y(), 0.0) - inset * frame.into() + sideways * width * frame.left();

  const TopForm form{depth, width, top, p.thickness};
  if (!add_furniture(builder, table_boxes(frame, form), "table:", world)) return false;
  return add_things_on(builder, world, frame, form, p.items_mix, items, "table:");
}

}  // namespace

FamilyType table_family() {
  return family_type<Table>(
      "a table whose top is a little below the goal, its near edge towards the robot, with things on it");
}

}  // namespace moma
