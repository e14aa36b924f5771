#include <optional>
#include <utility>
#include <vector>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"

namespace moma {
namespace {

/// A passage between two high walls with the goal behind it; its width is that of the robot's footprint plus a margin.
/// For mobile bases. Solvable by construction for a positive margin, if the arm fits above the footprint: the base
/// drives straight through.
struct Narrow {
  using Uniform = Distribution::Uniform;
  Placement placement{.distance = Distribution(Uniform{2.5, 4.0})};
  Distribution margin{Distribution::Fixed{0.15}};  ///< [m]
  WallAcross place{.along = Distribution(Uniform{0.4, 0.6}),
                   .offset = Distribution(Uniform{-0.5, 0.5}),
                   .turn = Distribution(Uniform{-0.4, 0.4})};
  Distribution length{Uniform{0.3, 0.8}};  ///< [m]
  double wall = 2.5;                       ///< [m]
  double height = 2.0;                     ///< [m]
};

constexpr void describe(auto& v, Of<Narrow>) {
  using T = Narrow;
  v.inlined(&T::placement);
  v.member("margin", &T::margin,
           quantity("m", "margin of the passage on either side of a base that drives straight through"));
  v.inlined(&T::place);
  v.member("length", &T::length, positive("m", "length of the passage, the thickness of its walls"));
  v.member("wall", &T::wall, positive("m", "length of the wall on each side"));
  v.member("height", &T::height, positive("m", "height of the walls"));
}

bool build(const Narrow& p, SceneBuilder& builder, World& world) {
  if (!builder.mobile()) return builder.reject("narrow: a fixed base cannot drive through it");
  if (!builder.place_robot(p.placement, world)) return false;
  Draws draws = builder.draws(Stream::kObjects);
  const double margin = p.margin.sample(draws);
  const std::optional<FurnitureFrame> frame = frame_of_passage(builder, world, p.place, draws, "narrow");
  if (!frame) return false;
  const double length = p.length.sample(draws);

  const double width = 2.0 * (base_half_width(builder) + margin);
  if (!(width > 0.0)) return builder.reject("narrow: no room between the walls (margin)");
  std::vector<WorldObject> boxes;
  add_left_and_right(boxes, *frame, "wall", {0.0, 0.5 * (width + p.wall), 0.5 * p.height}, {length, p.wall, p.height});
  return add_furniture(builder, std::move(boxes), "narrow:", world);
}

}  // namespace

FamilyType narrow_family() {
  return family_type<Narrow>("a passage as wide as the base and a margin, the goal behind; mobile bases");
}

}  // namespace moma
