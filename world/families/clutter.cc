#include <cmath>

#include "world/scenario/family.h"
#include "world/scenario/object_mix.h"

namespace moma {
namespace {

constexpr int kObjectTries = 100;

/// Solids along the straight way from start to goal, clear of start and witness.
class ClutterFamily final : public Family {
 public:
  explicit ClutterFamily(config::MapReader& in) {
    placement_.read(in);
    read_count(in, "objects", objects_, 0, 1000);
    read(in, "along", along_);
    read(in, "lateral", lateral_);
    mix_.read(in);
  }

  nlohmann::ordered_json to_json() const override {
    nlohmann::ordered_json out;
    placement_.write(out);
    out["objects"] = objects_.to_json();
    out["along"] = along_.to_json();
    out["lateral"] = lateral_.to_json();
    mix_.write(out);
    return out;
  }

  bool build(SceneBuilder& builder, World& world) const override {
    if (!builder.place_robot(placement_, world)) return false;
    // A mobile robot leaves with its base, a fixed one with its tool.
    const Vector3 from =
        builder.mobile() ? Vector3(world.start.base.x(), world.start.base.y(), 0.0) : builder.start_tip();
    Vector3 way = world.goal.X_WG.translation() - from;
    way.z() = 0.0;
    const double length = way.norm();
    const Vector3 forward = length > 1e-6 ? Vector3(way / length) : Vector3::UnitX();
    const Vector3 left(-forward.y(), forward.x(), 0.0);

    Draws number = builder.draws(Stream::kObjects);
    const int count = objects_.sample_count(number);
    for (int i = 0; i < count; ++i) {
      WorldObject object;
      object.name = "object" + std::to_string(i + 1);
      bool placed = false;
      double along = 0.0;
      for (int k = 0; k < kObjectTries && !placed; ++k) {
        // Item 0 is the number of objects; each object's tries have items of their own.
        Draws draws = builder.draws(Stream::kObjects, 1 + static_cast<std::uint64_t>(i * kObjectTries + k));
        // The place along the way is kept over the tries: else all that does not fit beside start and goal would end
        // up in the middle.
        const double again = along_.sample(draws);
        if (k == 0) along = again;
        const Vector3 p = from + along * length * forward + lateral_.sample(draws) * left;
        mix_.sample(draws, p.x(), p.y(), object);
        placed = builder.stands_clear(object, builder.clearance());
        if (!placed) builder.drawn_again("an object not clear of start and goal");
      }
      if (!placed) return builder.reject("objects: no place clear of start and goal (worlds.clearance)");
      world.objects.push_back(std::move(object));
    }
    return true;
  }

 private:
  Placement placement_;
  Distribution objects_{Distribution::Uniform{5.0, 15.0}};
  Distribution along_{Distribution::Uniform{0.0, 1.0}};   ///< part of the way from start to goal
  Distribution lateral_{Distribution::Normal{0.0, 0.6}};  ///< to the left of the way [m]
  ObjectMix mix_;
};

}  // namespace

std::unique_ptr<const Family> read_clutter(config::MapReader& in) { return std::make_unique<ClutterFamily>(in); }

}  // namespace moma
