#include <cmath>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"

namespace moma {
namespace {

/// A wall across the way with a door in it: the goal is behind. For mobile bases.
class DoorwayFamily final : public Family {
 public:
  explicit DoorwayFamily(config::MapReader& in) {
    const auto positive = config::Range::positive();
    placement_.distance = Distribution(Distribution::Uniform{2.5, 4.0});
    placement_.read(in);
    read(in, "width", width_, positive);
    read(in, "along", along_, {0.0, 1.0});
    read(in, "offset", offset_);
    read(in, "turn", turn_);
    read(in, "height", height_, positive);
    in.read("wall", wall_, positive);
    in.read("thickness", thickness_, positive);
    in.read("lintel", lintel_);
  }

  nlohmann::ordered_json to_json() const override {
    nlohmann::ordered_json out;
    placement_.write(out);
    out["width"] = width_.to_json();
    out["along"] = along_.to_json();
    out["offset"] = offset_.to_json();
    out["turn"] = turn_.to_json();
    out["height"] = height_.to_json();
    out["wall"] = wall_;
    out["thickness"] = thickness_;
    out["lintel"] = lintel_;
    return out;
  }

  bool build(SceneBuilder& builder, World& world) const override {
    if (!builder.mobile()) return builder.reject("doorway: a fixed base cannot pass a door");
    if (!builder.place_robot(placement_, world)) return false;
    Draws draws = builder.draws(Stream::kObjects);
    const double width = width_.sample(draws);
    const double along = along_.sample(draws);
    const double offset = offset_.sample(draws);
    const double turn = turn_.sample(draws);
    const double height = height_.sample(draws);

    const Vector3 start(world.start.base.x(), world.start.base.y(), 0.0);
    const Vector3 end(world.witness.base.x(), world.witness.base.y(), 0.0);
    const Vector3 way = end - start;
    FurnitureFrame frame;  // in the middle of the door, x through it
    frame.yaw = std::atan2(way.y(), way.x());
    frame.origin = start + along * way;
    frame.origin = frame.point(0.0, offset, 0.0);
    frame.yaw += turn;

    // Base and tool must be on the far side, or there would be nothing to pass.
    const Vector3 through(std::cos(frame.yaw), std::sin(frame.yaw), 0.0);
    if (through.dot(world.goal.X_WG.translation() - frame.origin) < 0.0 || through.dot(end - frame.origin) < 0.0)
      return builder.reject("doorway: the goal is not behind it");
    const double side = 0.5 * (width + wall_);
    std::vector<WorldObject> boxes;
    boxes.push_back(furniture_box(frame, "wall_left", {0.0, side, 0.5 * height}, {thickness_, wall_, height}));
    boxes.push_back(furniture_box(frame, "wall_right", {0.0, -side, 0.5 * height}, {thickness_, wall_, height}));
    if (lintel_)
      boxes.push_back(furniture_box(frame, "lintel", {0.0, 0.0, height + 0.1}, {thickness_, width + 2.0 * wall_, 0.2}));
    return add_furniture(builder, std::move(boxes), "doorway:", world);
  }

 private:
  Placement placement_;
  Distribution width_{Distribution::Uniform{0.9, 1.4}};    ///< of the door [m]
  Distribution along_{Distribution::Uniform{0.35, 0.65}};  ///< part of the way from start to goal
  Distribution offset_{Distribution::Uniform{-0.4, 0.4}};  ///< of its middle beside the way [m]
  Distribution turn_{Distribution::Uniform{-0.3, 0.3}};    ///< of the wall against the way [rad]
  Distribution height_{Distribution::Uniform{1.9, 2.1}};   ///< of the door [m]
  double wall_ = 2.0;                                      ///< length of the wall on each side [m]
  double thickness_ = 0.1;                                 ///< of the wall [m]
  bool lintel_ = true;
};

}  // namespace

std::unique_ptr<const Family> read_doorway(config::MapReader& in) { return std::make_unique<DoorwayFamily>(in); }

}  // namespace moma
