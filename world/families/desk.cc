#include <cmath>
#include <limits>
#include <vector>

#include "controller/model/floor_reach.h"
#include "world/scenario/family.h"
#include "world/scenario/furniture.h"
#include "world/scenario/objects.h"

namespace moma {
namespace {

/// The robot stands on a table, which is an obstacle, with goals and objects above it. The floor is far below.
struct Desk {
  using Uniform = Distribution::Uniform;
  Placement placement;
  double above = 0.05;                        ///< [m]
  double room = 0.06;                         ///< [m]
  Distribution width{Uniform{1.0, 1.6}};      ///< [m]
  Distribution depth{Uniform{0.7, 0.9}};      ///< [m]
  Distribution behind{Uniform{0.15, 0.3}};    ///< [m]
  Distribution sideways{Uniform{-0.2, 0.2}};  ///< [m]
  double thickness = 0.04;                    ///< [m]
  Count items{Uniform{0.0, 5.0}};
  ObjectMix items_mix = small_things();
};

constexpr void describe(auto& v, Of<Desk>) {
  using T = Desk;
  v.inlined(&T::placement);
  v.member("above", &T::above, non_negative("m", "least height of the goal above the tabletop"));
  v.member("room", &T::room,
           positive("m", "distance between the tabletop and the robot's lowest shape: the robot's base plate"));
  v.member("width", &T::width, positive("m", "width of the table, to the robot's left and right"));
  v.member("depth", &T::depth, positive("m", "depth of the table, ahead of the robot and behind it"));
  v.member("behind", &T::behind, positive("m", "part of the table's depth behind the robot"));
  v.member("sideways", &T::sideways, quantity("m", "position of the table's middle to the robot's left"));
  v.member("thickness", &T::thickness, positive("m", "thickness of the tabletop"));
  v.member("items", &T::items, in_range({0, 100}, "", "number of objects on the table"));
  v.inlined(&T::items_mix);
}

/// Returns the lowest point of the shapes that no joint can lift; the robot's support is below all of them.
double lowest_standing(const SceneBuilder& builder) {
  const RobotModel& model = builder.model();
  const std::vector<bool> lifted = floor_reach(model).lifted;
  Kinematics kinematics(builder.model_pointer());
  kinematics.update(Vector3::Zero(), model.ready);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < model.shapes.size(); ++i)
    if (!lifted[i]) least = std::min(least, lowest_point(model.shapes[i].shape, kinematics.X_WS(model.shapes[i])));
  // An arm without a base of its own begins at its mount.
  return std::isfinite(least) ? least : model.base.X_BM.translation().z();
}

bool build(const Desk& p, SceneBuilder& builder, World& world) {
  if (builder.mobile()) return builder.reject("desk: the robot has a base that moves; it cannot stand on a table");
  const double top = lowest_standing(builder) - p.room;
  if (top < p.thickness + 0.3)
    return builder.reject("desk: the robot stands too low for a table under it; base.mount.position says how high");
  if (!builder.place_robot(p.placement, world)) return false;
  if (world.goal.X_WG.translation().z() < top + p.above) return builder.reject("desk: the goal is not above the table");
  Draws draws = builder.draws(Stream::kObjects);
  TopForm form;
  form.width = p.width.sample(draws);
  form.depth = p.depth.sample(draws);
  const double behind = p.behind.sample(draws);
  const double sideways = p.sideways.sample(draws);
  const int items = p.items.sample(draws);
  form.height = top;
  form.thickness = p.thickness;
  const FurnitureFrame frame{{-behind, sideways, 0.0}, 0.0};
  if (!add_furniture(builder, table_boxes(frame, form), "desk:", world)) return false;
  return add_things_on(builder, world, frame, form, p.items_mix, items, "desk:");
}

}  // namespace

FamilyType desk_family() {
  return family_type<Desk>(
      "the robot stands on a table: goals above the top, things on it; robots without a base that moves");
}

}  // namespace moma
