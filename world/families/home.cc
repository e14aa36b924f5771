#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"
#include "world/scenario/walk.h"

namespace moma {
namespace {

/// Rooms one behind the other with a door in each wall between them, furniture along their long walls, and the goal
/// above a table, or in a shelf, of the last room. People walk from room to room: they come round corners. For mobile
/// bases.
struct Home {
  using Uniform = Distribution::Uniform;
  Placement placement{.distance = Distribution(Uniform{3.5, 5.0}), .tip_height = 0.45};
  Count doors{Uniform{1.0, 2.0}};
  Distribution width{Uniform{0.95, 1.2}};       ///< of a door [m]
  Distribution offset{Uniform{-0.7, 0.7}};      ///< of a door's middle from the way [m]
  Distribution half_width{Uniform{1.9, 2.4}};   ///< of the rooms [m]
  double beyond = 1.6;                          ///< length of the home before the start and behind the goal [m]
  double wall_height = 2.2;                     ///< of the walls [m]
  double door_height = 2.0;                     ///< [m]
  double thickness = 0.1;                       ///< of the walls [m]
  double shelf = 0.3;                           ///< share of goals in a shelf, others above a table [1]
  double above = 0.12;                          ///< height of the goal above the tabletop, or the board [m]
  Distribution inset{Uniform{0.05, 0.2}};       ///< depth of the goal behind the furniture's front [m]
  Count furniture{Uniform{2.0, 6.0}};           ///< other pieces, along the walls
  Distribution piece_width{Uniform{0.6, 1.2}};  ///< [m]
  Distribution piece_depth{Uniform{0.3, 0.5}};  ///< [m]
  Count items{Uniform{0.0, 3.0}};               ///< things on a table
  ObjectMix items_mix = small_things();
  Count people{Distribution::Fixed{0.0}};
  double horizon = 120.0;  ///< [s]
  Walk walker{.speed = Distribution(Distribution::Normal{0.8, 0.2}), .margin = 1.4};
};

constexpr void describe(auto& v, Of<Home>) {
  using T = Home;
  v.inlined(&T::placement);
  v.member("doors", &T::doors, in_range({1, 10}, "", "number of walls across the way, each with a door"));
  v.member("width", &T::width, positive("m", "width of a door"));
  v.member("offset", &T::offset, quantity("m", "distance of a door's middle from the way"));
  v.member("half_width", &T::half_width, positive("m", "half the width of the rooms, from the way to the side walls"));
  v.member("beyond", &T::beyond, positive("m", "length of the home before the start and behind the goal"));
  v.member("wall_height", &T::wall_height, positive("m", "height of the walls"));
  v.member("door_height", &T::door_height, positive("m", "height of the doors"));
  v.member("thickness", &T::thickness, positive("m", "thickness of the walls"));
  v.member("shelf", &T::shelf, in_range({0.0, 1.0}, "1", "share of goals in a shelf; others are above a table"));
  v.member("above", &T::above, positive("m", "height of the goal above the tabletop or the shelf's board"));
  v.member("inset", &T::inset, quantity("m", "depth of the goal behind the front of table or shelf"));
  v.member("furniture", &T::furniture, in_range({0, 100}, "", "number of other tables and shelves, along the walls"));
  v.member("piece_width", &T::piece_width, positive("m", "width of a piece of furniture"));
  v.member("piece_depth", &T::piece_depth, positive("m", "depth of a piece of furniture"));
  v.member("items", &T::items, in_range({0, 100}, "", "number of things on each table"));
  v.inlined(&T::items_mix);
  v.member("people", &T::people, in_range({0, 100}, "", "number of people who walk"));
  v.member("horizon", &T::horizon,
           in_range({0.0, 3600.0, true, false}, "s", "time for which start and witness are clear of people"));
  v.inlined(&T::walker);
}

constexpr double kBoard = 0.03;                       // thickness of tabletops and boards [m]
constexpr double kTableLow = 0.35, kTableHigh = 1.1;  // heights of a tabletop at the goal [m]
constexpr double kFreeAtDoor = 0.7;                   // along the way, beside a wall with a door [m]
constexpr double kTurnAtDoor = 0.9;                   // before and behind a door: a robot turns there [m]

void rename(std::vector<WorldObject>& boxes, const std::string& piece) {
  for (WorldObject& box : boxes) box.name = piece + "_" + box.name;
}

std::vector<WorldObject> shelf_of(const FurnitureFrame& frame, double width, double depth, double board) {
  ShelfForm form{.width = width, .depth = depth, .opening = 0.42, .thickness = kBoard, .back = true};
  form.board = board;
  form.total = std::max(1.5, board + form.opening + kBoard);
  return shelf_boxes(frame, form, "shelf_board");
}

bool meet(const WorldObject& a, const WorldObject& b, double within) {
  return shape_distance(a.shape, a.X_WO, b.shape, b.X_WO).d < within;
}

bool build(const Home& p, SceneBuilder& builder, World& world) {
  if (!builder.mobile()) return builder.reject("home: a fixed base cannot drive through it");
  if (!builder.place_robot(p.placement, world)) return false;
  Draws draws = builder.draws(Stream::kObjects);
  const int doors = p.doors.sample(draws);
  const double half_width = p.half_width.sample(draws);
  const int pieces = p.furniture.sample(draws), items = p.items.sample(draws), people = p.people.sample(draws);
  const bool in_shelf = draws.uniform() < p.shelf;
  const double inset = p.inset.sample(draws);

  // Walls. F begins at the start, x along the way to the witness.
  const Vector3 way(world.witness.base.x(), world.witness.base.y(), 0.0);
  const double distance = way.norm(), length = distance + 2.0 * p.beyond;
  FurnitureFrame frame;
  frame.yaw = std::atan2(way.y(), way.x());
  std::vector<WorldObject> walls, doorways;
  std::vector<double> walls_at;
  std::vector<Vector3> passages;
  for (int k = 0; k < doors; ++k) {
    const double at = distance * (k + 1) / (doors + 1), door = p.width.sample(draws);
    const double room = std::max(0.0, half_width - 0.5 * door);
    const double middle = std::clamp(p.offset.sample(draws), -room, room);
    const std::string name = "wall" + std::to_string(k + 1);
    for (const double side : {1.0, -1.0}) {
      const double inner = middle + 0.5 * side * door, outer = side * half_width;
      walls.push_back(furniture_box(frame, name + (side > 0.0 ? "_left" : "_right"),
                                    {at, 0.5 * (inner + outer), 0.5 * p.wall_height},
                                    {p.thickness, std::abs(outer - inner), p.wall_height}));
    }
    if (p.door_height < p.wall_height)
      walls.push_back(furniture_box(frame, name + "_lintel", {at, middle, 0.5 * (p.door_height + p.wall_height)},
                                    {p.thickness, door, p.wall_height - p.door_height}));
    walls_at.push_back(at);
    doorways.push_back(
        furniture_box(frame, "", {at, middle, 0.5 * p.door_height}, {2.0 * kTurnAtDoor, door, p.door_height}));
    passages.push_back(frame.point(at, middle, 0.0));
  }
  const Vector3 goal = world.goal.X_WG.translation();
  if (frame.into().dot(goal) < walls_at.back() + 0.3) return builder.reject("home: the goal is not in the last room");
  add_left_and_right(walls, frame, "side", {0.5 * distance, half_width + 0.5 * p.thickness, 0.5 * p.wall_height},
                     {length, p.thickness, p.wall_height});
  for (const auto& [name, at] : {std::pair{"front", -p.beyond}, std::pair{"end", distance + p.beyond}})
    walls.push_back(
        furniture_box(frame, name, {at, 0.0, 0.5 * p.wall_height}, {p.thickness, 2.0 * half_width, p.wall_height}));
  if (!add_furniture(builder, std::move(walls), "home: walls", world)) return false;

  // The furniture at the goal, its front towards the hand.
  FurnitureFrame at_goal;
  const Vector3 approach = builder.approach();
  if (in_shelf && std::hypot(approach.x(), approach.y()) < 0.85)
    return builder.reject("home: the tool does not point into the shelf");
  at_goal.yaw = in_shelf ? std::atan2(approach.y(), approach.x()) : heading_to_goal(world);
  at_goal.origin = Vector3(goal.x(), goal.y(), 0.0) - inset * at_goal.into();
  const double top = goal.z() - p.above;
  if (!in_shelf && (top < kTableLow || top > kTableHigh)) return builder.reject("home: no height for a table");
  const double wide = p.piece_width.sample(draws), deep = p.piece_depth.sample(draws);
  std::vector<WorldObject> furniture =
      in_shelf ? shelf_of(at_goal, wide, deep, top - 0.5 * kBoard) : table_boxes(at_goal, {deep, wide, top, kBoard});
  for (const WorldObject& doorway : doorways)
    if (std::ranges::any_of(furniture, [&](const WorldObject& box) { return meet(box, doorway, 0.0); }))
      return builder.reject("home: the furniture at the goal stands in a door");
  if (!add_furniture(builder, std::move(furniture), "home: furniture at the goal", world)) return false;
  if (!in_shelf && !add_things_on(builder, world, at_goal, {deep, wide, top, kBoard}, p.items_mix, items, "home:"))
    return false;

  // Other furniture, with its back to a side wall, in nobody's door.
  constexpr int kTries = 60;
  for (int piece = 0; piece < pieces; ++piece) {
    for (int k = 0; k < kTries; ++k) {
      Draws one = builder.draws(Stream::kObjects, 1'000'000 + static_cast<std::uint64_t>(piece * kTries + k));
      const double width = p.piece_width.sample(one), depth = p.piece_depth.sample(one);
      const double along = one.uniform(-p.beyond + 0.5 * width + p.thickness, length - p.beyond - 0.5 * width);
      const double side = one.uniform() < 0.5 ? 1.0 : -1.0;
      const bool table = one.uniform() < 0.5;
      const double high = one.uniform(0.4, 0.9);
      FurnitureFrame there;
      there.yaw = frame.yaw + side * 0.5 * std::numbers::pi;
      there.origin = frame.point(along, side * (half_width - depth - kBoard), 0.0);
      std::vector<WorldObject> boxes =
          table ? table_boxes(there, {depth, width, high, kBoard}) : shelf_of(there, width - 2.0 * kBoard, depth, high);
      rename(boxes, "piece" + std::to_string(piece + 1));
      const bool in_door =
          std::ranges::any_of(walls_at, [&](double at) { return std::abs(at - along) < 0.5 * width + kFreeAtDoor; });
      const WorldObject whole = furniture_box(there, "", {0.5 * depth, 0.0, 0.5}, {depth, width, 1.0});
      const bool meets = std::ranges::any_of(world.objects, [&](const WorldObject& other) {
        return !other.name.starts_with("side") && meet(whole, other, 0.1);
      });
      if (in_door || meets || !std::ranges::all_of(boxes, [&](const WorldObject& box) {
            return builder.stands_clear(box, builder.clearance());
          })) {
        builder.drawn_again("a piece of furniture not clear of start, goal, doors and others");
        continue;
      }
      std::move(boxes.begin(), boxes.end(), std::back_inserter(world.objects));
      break;
    }
  }

  const std::vector<WorldObject> solids = world.objects;
  const ObjectPlacing walkers{.count = people,
                              .tries = 400,
                              .name = "person",
                              .drawn_again = "a path not clear of start, goal and walls",
                              .out_of_tries = "home: no path for a person clear of start and goal"};
  const Way along{Vector3::Zero(), frame.into(), distance};
  return walkers.place(builder, world, [&](const ObjectTry& at, WorldObject& person) {
    return p.walker.sample(builder, along, p.items_mix, p.horizon, at.item, person, {solids, passages});
  });
}

}  // namespace

FamilyType home_family() {
  return family_type<Home>("rooms with doors, tables, shelves and things on them, people who walk; mobile bases");
}

}  // namespace moma
