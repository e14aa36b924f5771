#include <optional>
#include <utility>
#include <vector>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"

namespace moma {
namespace {

/// A wall across the way with a door in it, and the goal behind. For mobile bases.
struct Doorway {
  using Uniform = Distribution::Uniform;
  Placement placement{.distance = Distribution(Uniform{2.5, 4.0})};
  Distribution width{Uniform{0.9, 1.4}};  ///< [m]
  WallAcross place;
  Distribution height{Uniform{1.9, 2.1}};  ///< [m]
  double wall = 2.0;                       ///< [m]
  double thickness = 0.1;                  ///< [m]
  bool lintel = true;
};

constexpr void describe(auto& v, Of<Doorway>) {
  using T = Doorway;
  v.inlined(&T::placement);
  v.member("width", &T::width, positive("m", "width of the door"));
  v.inlined(&T::place);
  v.member("height", &T::height, positive("m", "height of the door and its wall"));
  v.member("wall", &T::wall, positive("m", "length of the wall on each side"));
  v.member("thickness", &T::thickness, positive("m", "thickness of the wall"));
  v.member("lintel", &T::lintel, {.text = "a beam above the door"});
}

bool build(const Doorway& p, SceneBuilder& builder, World& world) {
  if (!builder.mobile()) return builder.reject("doorway: a fixed base cannot pass a door");
  if (!builder.place_robot(p.placement, world)) return false;
  Draws draws = builder.draws(Stream::kObjects);
  const double width = p.width.sample(draws);
  const std::optional<FurnitureFrame> frame = frame_of_passage(builder, world, p.place, draws, "doorway");
  if (!frame) return false;
  const double height = p.height.sample(draws);

  std::vector<WorldObject> boxes;
  add_left_and_right(boxes, *frame, "wall", {0.0, 0.5 * (width + p.wall), 0.5 * height}, {p.thickness, p.wall, height});
  if (p.lintel)
    boxes.push_back(
        furniture_box(*frame, "lintel", {0.0, 0.0, height + 0.1}, {p.thickness, width + 2.0 * p.wall, 0.2}));
  return add_furniture(builder, std::move(boxes), "doorway:", world);
}

}  // namespace

FamilyType doorway_family() {
  return family_type<Doorway>("a wall across the way with a door in it, the goal behind; mobile bases");
}

}  // namespace moma
