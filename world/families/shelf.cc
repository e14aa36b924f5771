#include <cmath>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"

namespace moma {
namespace {

/// A shelf of boards with the goal in one of its compartments, open towards the side the tool comes from.
class ShelfFamily final : public Family {
 public:
  explicit ShelfFamily(config::MapReader& in) {
    const auto positive = config::Range::positive();
    placement_.tip_height = 0.25;
    placement_.read(in);
    read(in, "width", width_, positive);
    read(in, "opening", opening_, positive);
    read(in, "depth", depth_, positive);
    read(in, "inset", inset_);
    read(in, "height", height_, positive);
    in.read("thickness", thickness_, positive);
    in.read("level", level_, {0.0, 1.0});
    in.read("back", back_);
  }

  nlohmann::ordered_json to_json() const override {
    nlohmann::ordered_json out;
    placement_.write(out);
    out["width"] = width_.to_json();
    out["opening"] = opening_.to_json();
    out["depth"] = depth_.to_json();
    out["inset"] = inset_.to_json();
    out["height"] = height_.to_json();
    out["thickness"] = thickness_;
    out["level"] = level_;
    out["back"] = back_;
    return out;
  }

  bool build(SceneBuilder& builder, World& world) const override {
    if (!builder.place_robot(placement_, world)) return false;
    // The tool must come in roughly level, or no compartment would let it in.
    const Vector3 approach = builder.approach();
    const double level = std::hypot(approach.x(), approach.y());
    if (level < level_) return builder.reject("shelf: the tool does not point into it (level)");

    Draws draws = builder.draws(Stream::kObjects);
    const double width = width_.sample(draws);
    const double opening = opening_.sample(draws);
    const double depth = depth_.sample(draws);
    const double inset = inset_.sample(draws);
    const double height = height_.sample(draws);
    const double sideways = draws.uniform(-0.25, 0.25) * width;
    const double up = draws.uniform(0.4, 0.6) * opening;  // goal above the compartment's floor

    const Vector3 goal = world.goal.X_WG.translation();
    FurnitureFrame frame;
    frame.yaw = std::atan2(approach.y(), approach.x());
    const Vector3 in(std::cos(frame.yaw), std::sin(frame.yaw), 0.0);
    const Vector3 left(-in.y(), in.x(), 0.0);
    frame.origin = Vector3(goal.x(), goal.y(), 0.0) - inset * in + sideways * left;

    const double pitch = opening + thickness_;
    const double board = goal.z() - up - 0.5 * thickness_;  // middle of the board below the goal
    const double total = std::max(height, board + pitch);
    std::vector<WorldObject> boxes;
    // Boards first: they decide most tries.
    int number = 0;
    for (double z = board - pitch * std::floor(board / pitch); z < total + 0.5 * thickness_; z += pitch)
      boxes.push_back(furniture_box(frame, "shelf_board" + std::to_string(++number), {0.5 * depth, 0.0, z},
                                    {depth, width, thickness_}));
    for (const double side : {1.0, -1.0})
      boxes.push_back(furniture_box(frame, side > 0.0 ? "shelf_left" : "shelf_right",
                                    {0.5 * depth, side * 0.5 * (width + thickness_), 0.5 * total},
                                    {depth, thickness_, total}));
    if (back_)
      boxes.push_back(furniture_box(frame, "shelf_back", {depth + 0.5 * thickness_, 0.0, 0.5 * total},
                                    {thickness_, width + 2.0 * thickness_, total}));
    return add_furniture(builder, std::move(boxes), "shelf:", world);
  }

 private:
  Placement placement_;
  Distribution width_{Distribution::Uniform{0.6, 1.0}};     ///< between its sides [m]
  Distribution opening_{Distribution::Uniform{0.35, 0.5}};  ///< between two boards [m]
  Distribution depth_{Distribution::Uniform{0.3, 0.4}};     ///< [m]
  Distribution inset_{Distribution::Uniform{0.05, 0.2}};    ///< goal behind the front [m]
  Distribution height_{Distribution::Uniform{1.2, 1.9}};    ///< of the whole [m]
  double thickness_ = 0.03;                                 ///< of its boards [m]
  double level_ = 0.85;                                     ///< least horizontal part of the tool's direction
  bool back_ = true;
};

}  // namespace

std::unique_ptr<const Family> read_shelf(config::MapReader& in) { return std::make_unique<ShelfFamily>(in); }

}  // namespace moma
