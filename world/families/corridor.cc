#include <array>
#include <cmath>

#include "world/scenario/family.h"
#include "world/scenario/furniture.h"
#include "world/scenario/object_mix.h"

namespace moma {
namespace {

constexpr int kObjectTries = 100;

/// Two walls along the way, start and goal between them, with things that stand in the corridor. For mobile bases.
class CorridorFamily final : public Family {
 public:
  explicit CorridorFamily(config::MapReader& in) {
    const auto positive = config::Range::positive();
    placement_.distance = Distribution(Distribution::Uniform{2.0, 4.0});
    mix_.standing = 1.0;
    placement_.read(in);
    read(in, "width", width_, positive);
    read(in, "offset", offset_);
    read(in, "wall_height", wall_height_, positive);
    in.read("beyond", beyond_, config::Range::non_negative());
    in.read("thickness", thickness_, positive);
    read_count(in, "objects", objects_, 0, 100);
    mix_.read(in);
  }

  nlohmann::ordered_json to_json() const override {
    nlohmann::ordered_json out;
    placement_.write(out);
    out["width"] = width_.to_json();
    out["offset"] = offset_.to_json();
    out["wall_height"] = wall_height_.to_json();
    out["beyond"] = beyond_;
    out["thickness"] = thickness_;
    out["objects"] = objects_.to_json();
    mix_.write(out);
    return out;
  }

  bool build(SceneBuilder& builder, World& world) const override {
    if (!builder.mobile()) return builder.reject("corridor: a fixed base cannot drive along it");
    if (!builder.place_robot(placement_, world)) return false;
    Draws draws = builder.draws(Stream::kObjects);
    const double width = width_.sample(draws);
    const double offset = offset_.sample(draws);
    const double height = wall_height_.sample(draws);
    const int count = objects_.sample_count(draws);

    const Vector3 way(world.witness.base.x(), world.witness.base.y(), 0.0);  // the start is the origin
    const double length = way.norm() + 2.0 * beyond_;
    FurnitureFrame frame;  // on the corridor's middle line, before the start
    frame.yaw = std::atan2(way.y(), way.x());
    frame.origin = frame.point(-beyond_, offset, 0.0);
    std::vector<WorldObject> boxes;
    for (const double side : {1.0, -1.0})
      boxes.push_back(furniture_box(frame, side > 0.0 ? "wall_left" : "wall_right",
                                    {0.5 * length, side * 0.5 * (width + thickness_), 0.5 * height},
                                    {length, thickness_, height}));
    if (!between({builder.start_tip(), Vector3(world.goal.X_WG.translation())}, frame, width))
      return builder.reject("corridor: start or goal outside its walls");
    if (!add_furniture(builder, std::move(boxes), "corridor:", world)) return false;

    for (int i = 0; i < count; ++i) {
      WorldObject object;
      bool placed = false;
      for (int k = 0; k < kObjectTries && !placed; ++k) {
        Draws own = builder.draws(Stream::kObjects, 1 + static_cast<std::uint64_t>(i * kObjectTries + k));
        const Vector3 p = frame.point(own.uniform(0.0, 1.0) * length, own.uniform(-0.5, 0.5) * width, 0.0);
        mix_.sample(own, p.x(), p.y(), object);
        object.name = "object" + std::to_string(i + 1);
        placed = builder.stands_clear(object, builder.clearance());
        if (!placed) builder.drawn_again("an object not clear of start and goal");
      }
      if (!placed) return builder.reject("corridor: no place for an object clear of start and goal (worlds.clearance)");
      world.objects.push_back(std::move(object));
    }
    return true;
  }

 private:
  static bool between(const std::array<Vector3, 2>& points, const FurnitureFrame& frame, double width) {
    const Vector3 left(-std::sin(frame.yaw), std::cos(frame.yaw), 0.0);
    for (const Vector3& p : points)
      if (std::abs(left.dot(p - frame.origin)) > 0.5 * width) return false;
    return true;
  }

  Placement placement_;
  Distribution width_{Distribution::Uniform{1.3, 2.2}};        ///< between the walls [m]
  Distribution offset_{Distribution::Uniform{-0.2, 0.2}};      ///< of its middle beside the way [m]
  Distribution wall_height_{Distribution::Uniform{0.8, 2.0}};  ///< [m]
  double beyond_ = 1.0;                                        ///< of the walls before start and behind goal [m]
  double thickness_ = 0.1;                                     ///< of the walls [m]
  Distribution objects_{Distribution::Uniform{0.0, 2.0}};      ///< standing in it
  ObjectMix mix_;
};

}  // namespace

std::unique_ptr<const Family> read_corridor(config::MapReader& in) { return std::make_unique<CorridorFamily>(in); }

}  // namespace moma
