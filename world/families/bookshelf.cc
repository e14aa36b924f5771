#include <algorithm>
#include <cmath>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"

namespace moma {
namespace {

/// A bookshelf with its back to the robot's start. The goal lies between two boards, open on the far side, so that the
/// robot has to drive round and reach in. The witness stands before the open side. For mobile bases.
struct Bookshelf {
  using Uniform = Distribution::Uniform;
  Placement placement{.distance = Distribution(Uniform{2.5, 4.0}), .tip_height = 0.3};
  Distribution opening{Distribution::Fixed{0.35}};  ///< [m]
  Distribution inset{Distribution::Fixed{0.15}};    ///< [m]
  Distribution width{Uniform{1.0, 1.6}};            ///< [m]
  Distribution depth{Uniform{0.3, 0.4}};            ///< [m]
  Distribution height{Uniform{1.2, 1.8}};           ///< [m]
  double thickness = 0.03;                          ///< [m]
  double level = 0.8;                               ///< [1]
  double turned_away = 0.3;                         ///< [1]
};

constexpr void describe(auto& v, Of<Bookshelf>) {
  using T = Bookshelf;
  v.inlined(&T::placement);
  v.member("opening", &T::opening, positive("m", "distance between two boards"));
  v.member("inset", &T::inset, quantity("m", "depth of the goal behind the front"));
  v.member("width", &T::width, positive("m", "distance between the sides"));
  v.member("depth", &T::depth, positive("m", "depth of the boards"));
  v.member("height", &T::height, positive("m", "least total height"));
  v.member("thickness", &T::thickness, positive("m", "thickness of boards, sides and back"));
  v.member("level", &T::level, in_range({0.0, 1.0}, "1", "least horizontal component of the tool's direction"));
  v.member("turned_away", &T::turned_away,
           in_range({-1.0, 1.0}, "1",
                    "least cosine of the angle between the shelf's open side and the direction from the start to it"));
}

bool build(const Bookshelf& p, SceneBuilder& builder, World& world) {
  if (!builder.mobile()) return builder.reject("bookshelf: a fixed base cannot drive round it");
  if (!builder.place_robot(p.placement, world)) return false;
  const Vector3 approach = builder.approach();
  if (std::hypot(approach.x(), approach.y()) < p.level)
    return builder.reject("bookshelf: the tool does not point into it (level)");
  FurnitureFrame frame;
  frame.yaw = std::atan2(approach.y(), approach.x());
  const Vector3 goal = world.goal.X_WG.translation();
  Vector3 there(goal.x(), goal.y(), 0.0);
  if (there.norm() < 1e-6 || -frame.into().dot(there.normalized()) < p.turned_away)
    return builder.reject("bookshelf: open towards the start (turned_away)");

  Draws draws = builder.draws(Stream::kObjects);
  const double opening = p.opening.sample(draws);
  const double inset = p.inset.sample(draws);
  const double width = p.width.sample(draws);
  const double depth = std::max(p.depth.sample(draws), inset + p.thickness);
  const double height = p.height.sample(draws);
  const double sideways = draws.uniform(-0.3, 0.3) * width;
  const double up = draws.uniform(0.4, 0.6) * opening;  // goal above the board below it
  frame.origin = there - inset * frame.into() + sideways * frame.left();

  ShelfForm form{.width = width, .depth = depth, .opening = opening, .thickness = p.thickness};
  form.board = goal.z() - up - 0.5 * p.thickness;
  form.total = std::max(height, form.board + (opening + p.thickness) + p.thickness);
  return add_furniture(builder, shelf_boxes(frame, form, "board"), "bookshelf:", world);
}

}  // namespace

FamilyType bookshelf_family() {
  return family_type<Bookshelf>(
      "a shelf with its back to the start: round it, and in between two of its boards; mobile bases");
}

}  // namespace moma
