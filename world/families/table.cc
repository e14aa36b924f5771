#include <cmath>
#include <numbers>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"
#include "world/scenario/object_mix.h"

namespace moma {
namespace {

constexpr int kItemTries = 50;

/// A table whose top is a little below the goal, its near edge towards the robot, with things standing on it.
class TableFamily final : public Family {
 public:
  explicit TableFamily(config::MapReader& in) {
    const auto positive = config::Range::positive();
    placement_.tip_height = 0.45;
    items_mix_.standing = 1.0;
    items_mix_.sphere_radius = Distribution(Distribution::Uniform{0.03, 0.06});
    items_mix_.box_edge = Distribution(Distribution::Uniform{0.05, 0.15});
    items_mix_.capsule_radius = Distribution(Distribution::Uniform{0.02, 0.05});
    items_mix_.standing_height = Distribution(Distribution::Uniform{0.08, 0.3});
    placement_.read(in);
    read(in, "above", above_, config::Range::non_negative());
    read(in, "inset", inset_);
    read(in, "width", width_, positive);
    read(in, "depth", depth_, positive);
    read(in, "turn", turn_);
    in.read("thickness", thickness_, positive);
    read_count(in, "items", items_, 0, 100);
    items_mix_.read(in);
  }

  nlohmann::ordered_json to_json() const override {
    nlohmann::ordered_json out;
    placement_.write(out);
    out["above"] = above_.to_json();
    out["inset"] = inset_.to_json();
    out["width"] = width_.to_json();
    out["depth"] = depth_.to_json();
    out["turn"] = turn_.to_json();
    out["thickness"] = thickness_;
    out["items"] = items_.to_json();
    items_mix_.write(out);
    return out;
  }

  bool build(SceneBuilder& builder, World& world) const override {
    if (!builder.place_robot(placement_, world)) return false;
    Draws draws = builder.draws(Stream::kObjects);
    const double above = above_.sample(draws);
    const double inset = inset_.sample(draws);
    const double width = width_.sample(draws);
    const double depth = depth_.sample(draws);
    const double turn = turn_.sample(draws);
    const double sideways = draws.uniform(-0.4, 0.4);
    const int items = items_.sample_count(draws);

    const Vector3 goal = world.goal.X_WG.translation();
    const double top = goal.z() - above;
    if (top < 0.3 || top > 1.3) return builder.reject("table: the goal is at no height for a table");
    // F's origin is the middle of the near edge.
    FurnitureFrame frame;
    frame.yaw = heading_to_goal(world) + turn;
    const Vector3 in(std::cos(frame.yaw), std::sin(frame.yaw), 0.0);
    const Vector3 left(-in.y(), in.x(), 0.0);
    frame.origin = Vector3(goal.x(), goal.y(), 0.0) - inset * in + sideways * width * left;

    const double leg = 0.06;
    const double under = top - thickness_;
    std::vector<WorldObject> boxes;
    boxes.push_back(
        furniture_box(frame, "table_top", {0.5 * depth, 0.0, top - 0.5 * thickness_}, {depth, width, thickness_}));
    int number = 0;
    for (const double x : {0.5 * leg, depth - 0.5 * leg})
      for (const double y : {0.5 * (width - leg), -0.5 * (width - leg)})
        boxes.push_back(
            furniture_box(frame, "table_leg" + std::to_string(++number), {x, y, 0.5 * under}, {leg, leg, under}));
    if (!add_furniture(builder, std::move(boxes), "table:", world)) return false;
    return add_items(builder, world, frame, items, depth, width, top);
  }

 private:
  bool add_items(SceneBuilder& builder, World& world, const FurnitureFrame& frame, int count, double depth,
                 double width, double top) const {
    for (int i = 0; i < count; ++i) {
      WorldObject item;
      bool placed = false;
      for (int k = 0; k < kItemTries && !placed; ++k) {
        Draws draws = builder.draws(Stream::kObjects, 1 + static_cast<std::uint64_t>(i * kItemTries + k));
        const Vector3 p = frame.point(draws.uniform(0.05, 0.95) * depth, draws.uniform(-0.45, 0.45) * width, 0.0);
        items_mix_.sample(draws, p.x(), p.y(), item);
        item.name = "item" + std::to_string(i + 1);
        const double lift = top - lowest_point(item.shape, item.X_WO);
        set_pose(item, item.X_WO.translation() + Vector3(0.0, 0.0, lift), item.file_rotation);
        placed = builder.stands_clear(item, builder.clearance());
        if (!placed) builder.drawn_again("an item not clear of start and goal");
      }
      if (!placed) return builder.reject("table: no place for an item clear of the goal (worlds.clearance)");
      world.objects.push_back(item);
    }
    return true;
  }

  Placement placement_;
  Distribution above_{Distribution::Uniform{0.06, 0.2}};   ///< goal above the top [m]
  Distribution inset_{Distribution::Uniform{0.05, 0.35}};  ///< goal behind the near edge [m]
  Distribution width_{Distribution::Uniform{0.8, 1.6}};    ///< along the near edge [m]
  Distribution depth_{Distribution::Uniform{0.5, 0.9}};    ///< [m]
  Distribution turn_{Distribution::Uniform{-0.4, 0.4}};    ///< of the table against the robot's line to the goal [rad]
  double thickness_ = 0.04;                                ///< of the top [m]
  Distribution items_{Distribution::Uniform{0.0, 4.0}};    ///< things on it
  ObjectMix items_mix_;
};

}  // namespace

std::unique_ptr<const Family> read_table(config::MapReader& in) { return std::make_unique<TableFamily>(in); }

}  // namespace moma
