#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"

namespace moma {
namespace {

/// A row of rooms, separated by walls across the way, each with a doorway of its own: the robot passes all of them to
/// its goal in the last room. Two long walls close the rooms at their sides. For mobile bases. A doorway is as wide as
/// the base driving straight, plus a margin on either side. Rooms are deep enough for the base to turn between two
/// walls, so that worlds with a positive margin are solvable if the arm fits above the base.
struct Maze {
  using Uniform = Distribution::Uniform;
  Placement placement{.distance = Distribution(Uniform{4.0, 6.0})};
  Count walls{Distribution::Fixed{2.0}};
  Distribution margin{Distribution::Fixed{0.25}};  ///< [m]
  Distribution offset{Uniform{-0.9, 0.9}};         ///< [m]
  double half_width = 1.8;                         ///< [m]
  double beyond = 1.5;                             ///< [m]
  double thickness = 0.1;                          ///< [m]
  double height = 1.6;                             ///< [m]
};

constexpr void describe(auto& v, Of<Maze>) {
  using T = Maze;
  v.inlined(&T::placement);
  v.member("walls", &T::walls, in_range({0, 10}, "", "number of walls across the way, each with a doorway"));
  v.member("margin", &T::margin,
           quantity("m", "margin of a doorway on either side of a base that drives straight through"));
  v.member("offset", &T::offset, quantity("m", "distance of a doorway's middle from the way"));
  v.member("half_width", &T::half_width, positive("m", "half the width of the rooms, from the way to the side walls"));
  v.member("beyond", &T::beyond, positive("m", "length of the rooms before the start and behind the goal"));
  v.member("thickness", &T::thickness, positive("m", "thickness of the walls"));
  v.member("height", &T::height, positive("m", "height of the walls"));
}

bool build(const Maze& p, SceneBuilder& builder, World& world) {
  if (!builder.mobile()) return builder.reject("maze: a fixed base cannot drive through it");
  if (!builder.place_robot(p.placement, world)) return false;
  Draws draws = builder.draws(Stream::kObjects);
  const int count = p.walls.sample(draws);

  const Vector3 way(world.witness.base.x(), world.witness.base.y(), 0.0);  // the start is the origin
  const double distance = way.norm();
  FurnitureFrame frame;  // at the start, x along the way
  frame.yaw = std::atan2(way.y(), way.x());
  for (const Vector3& tip : {builder.start_tip(), Vector3(world.goal.X_WG.translation())})
    if (std::abs(frame.left().dot(tip)) > p.half_width) return builder.reject("maze: start or goal outside its walls");

  const double half_base = base_half_width(builder);
  std::vector<WorldObject> boxes;
  double last = 0.0;  // position of the farthest wall along the way
  for (int k = 0; k < count; ++k) {
    const double at = distance * (k + 1) / (count + 1);
    const double half = half_base + p.margin.sample(draws);
    const double room = std::max(0.0, p.half_width - half);
    const double middle = std::clamp(p.offset.sample(draws), -room, room);
    if (!(half > 0.0)) return builder.reject("maze: no room in a doorway (margin)");
    last = at;
    for (const double side : {1.0, -1.0}) {
      const double inner = middle + side * half, outer = side * p.half_width;
      const double length = std::abs(outer - inner);
      if (length < 1e-3) continue;
      boxes.push_back(furniture_box(frame, "wall" + std::to_string(k + 1) + (side > 0.0 ? "_left" : "_right"),
                                    {at, 0.5 * (inner + outer), 0.5 * p.height}, {p.thickness, length, p.height}));
    }
  }
  if (count > 0 && frame.into().dot(world.goal.X_WG.translation()) < last)
    return builder.reject("maze: the goal is not in the last room");
  const double length = distance + 2.0 * p.beyond;
  add_left_and_right(boxes, frame, "side", {0.5 * distance, p.half_width + 0.5 * p.thickness, 0.5 * p.height},
                     {length, p.thickness, p.height});
  return add_furniture(builder, std::move(boxes), "maze:", world);
}

}  // namespace

FamilyType maze_family() {
  return family_type<Maze>("rooms one behind the other with a doorway in each wall between them; mobile bases");
}

}  // namespace moma
