#include <algorithm>
#include <cmath>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"

namespace moma {
namespace {

/// A shelf of boards with the goal in one of its compartments, open towards the side from which the tool comes.
struct Shelf {
  using Uniform = Distribution::Uniform;
  Placement placement{.tip_height = 0.25};
  Distribution width{Uniform{0.6, 1.0}};     ///< [m]
  Distribution opening{Uniform{0.35, 0.5}};  ///< [m]
  Distribution depth{Uniform{0.3, 0.4}};     ///< [m]
  Distribution inset{Uniform{0.05, 0.2}};    ///< [m]
  Distribution height{Uniform{1.2, 1.9}};    ///< [m]
  double thickness = 0.03;                   ///< [m]
  double level = 0.85;                       ///< [1]
  bool back = true;
};

constexpr void describe(auto& v, Of<Shelf>) {
  using T = Shelf;
  v.inlined(&T::placement);
  v.member("width", &T::width, positive("m", "distance between the sides"));
  v.member("opening", &T::opening, positive("m", "distance between two boards"));
  v.member("depth", &T::depth, positive("m", "depth of the boards"));
  v.member("inset", &T::inset, quantity("m", "depth of the goal behind the front"));
  v.member("height", &T::height, positive("m", "least total height"));
  v.member("thickness", &T::thickness, positive("m", "thickness of the boards"));
  v.member("level", &T::level, in_range({0.0, 1.0}, "1", "least horizontal component of the tool's direction"));
  v.member("back", &T::back, {.text = "closed at the back"});
}

bool build(const Shelf& p, SceneBuilder& builder, World& world) {
  if (!builder.place_robot(p.placement, world)) return false;
  // The tool must enter roughly level to fit into a compartment.
  const Vector3 approach = builder.approach();
  const double level = std::hypot(approach.x(), approach.y());
  if (level < p.level) return builder.reject("shelf: the tool does not point into it (level)");

  Draws draws = builder.draws(Stream::kObjects);
  const double width = p.width.sample(draws);
  const double opening = p.opening.sample(draws);
  const double depth = p.depth.sample(draws);
  const double inset = p.inset.sample(draws);
  const double height = p.height.sample(draws);
  const double sideways = draws.uniform(-0.25, 0.25) * width;
  const double up = draws.uniform(0.4, 0.6) * opening;  // goal above the compartment's floor

  const Vector3 goal = world.goal.X_WG.translation();
  FurnitureFrame frame;
  frame.yaw = std::atan2(approach.y(), approach.x());
  frame.origin = Vector3(goal.x(), goal.y(), 0.0) - inset * frame.into() + sideways * frame.left();

  ShelfForm form{.width = width, .depth = depth, .opening = opening, .thickness = p.thickness, .back = p.back};
  form.board = goal.z() - up - 0.5 * p.thickness;  // the board below the goal
  form.total = std::max(height, form.board + (opening + p.thickness));
  return add_furniture(builder, shelf_boxes(frame, form, "shelf_board"), "shelf:", world);
}

}  // namespace

FamilyType shelf_family() {
  return family_type<Shelf>(
      "a shelf of boards with the goal in a compartment, open towards the side the tool comes from");
}

}  // namespace moma
