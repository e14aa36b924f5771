#include <cmath>

#include "world/scenario/family.h"
#include "world/scenario/object_mix.h"

namespace moma {
namespace {

constexpr int kObjectTries = 200;

/// Solids that move in straight lines through the robot's way: some cross it at about the time when the robot is
/// there, some come along it from the far side. Their whole path over `horizon` is clear of start and witness, so a
/// robot that waits is not run over, and one that has arrived can stay.
class MovingFamily final : public Family {
 public:
  explicit MovingFamily(config::MapReader& in) {
    placement_.distance = Distribution(Distribution::Uniform{2.0, 4.0});
    mix_.standing = 1.0;
    mix_.height = Distribution(Distribution::Uniform{0.3, 1.2});
    placement_.read(in);
    read_count(in, "objects", objects_, 0, 1000);
    in.read("crossing", crossing_, {0.0, 1.0});
    read(in, "speed", speed_, config::Range::non_negative());
    read(in, "robot_speed", robot_speed_, config::Range::positive());
    read(in, "along", along_);
    read(in, "angle", angle_);
    read(in, "offset", offset_);
    in.read("horizon", horizon_, config::Range::positive());
    mix_.read(in);
  }

  nlohmann::ordered_json to_json() const override {
    nlohmann::ordered_json out;
    placement_.write(out);
    out["objects"] = objects_.to_json();
    out["crossing"] = crossing_;
    out["speed"] = speed_.to_json();
    out["robot_speed"] = robot_speed_.to_json();
    out["along"] = along_.to_json();
    out["angle"] = angle_.to_json();
    out["offset"] = offset_.to_json();
    out["horizon"] = horizon_;
    mix_.write(out);
    return out;
  }

  bool build(SceneBuilder& builder, World& world) const override {
    if (!builder.place_robot(placement_, world)) return false;
    Draws number = builder.draws(Stream::kObjects);
    const int count = objects_.sample_count(number);
    for (int i = 0; i < count; ++i) {
      WorldObject object;
      object.name = "object" + std::to_string(i + 1);
      bool placed = false;
      for (int k = 0; k < kObjectTries && !placed; ++k) {
        const auto item = 1 + static_cast<std::uint64_t>(i * kObjectTries + k);
        const double speed = sample(builder, world, item, object);
        placed = builder.clear_for(object, speed, horizon_, builder.clearance());
      }
      if (!placed) return builder.reject("objects: no path clear of start and goal (worlds.clearance)");
      world.objects.push_back(std::move(object));
    }
    return true;
  }

 private:
  /// One object and its motion; its speed is returned.
  double sample(const SceneBuilder& builder, const World& world, std::uint64_t item, WorldObject& object) const {
    const Vector3 from =
        builder.mobile() ? Vector3(world.start.base.x(), world.start.base.y(), 0.0) : builder.start_tip();
    Vector3 way = world.goal.X_WG.translation() - from;
    way.z() = 0.0;
    const double length = way.norm();
    const Vector3 forward = length > 1e-6 ? Vector3(way / length) : Vector3::UnitX();
    const Vector3 left(-forward.y(), forward.x(), 0.0);

    Draws draws = builder.draws(Stream::kMotion, item);
    const bool crosses = draws.uniform() < crossing_;
    const double speed = speed_.sample(draws);
    const double robot_speed = robot_speed_.sample(draws);
    const double along = along_.sample(draws);
    const double angle = angle_.sample(draws);
    const double offset = offset_.sample(draws);
    const double side = draws.uniform() < 0.5 ? -1.0 : 1.0;

    // Where object and robot would meet, the robot going straight at its nominal speed.
    const double meeting_time = along * length / robot_speed;
    Vector3 meeting = from + along * length * forward;
    Vector3 heading = side * left;
    if (!crosses) {
      heading = -forward;
      meeting += side * offset * left;
    }
    const Vector3 direction = Eigen::AngleAxisd(angle, Vector3::UnitZ()) * heading;
    const Vector3 begin = meeting - speed * meeting_time * direction;

    Draws solid = builder.draws(Stream::kObjects, item);
    mix_.sample(solid, begin.x(), begin.y(), object);
    LinearMotion motion;
    motion.V_W.tail<3>() = speed * direction;
    object.motion = motion;
    return speed;
  }

  Placement placement_;
  Distribution objects_{Distribution::Uniform{1.0, 4.0}};
  double crossing_ = 0.5;                                      ///< part of the objects that cross; the others approach
  Distribution speed_{Distribution::Uniform{0.1, 0.5}};        ///< [m/s]
  Distribution robot_speed_{Distribution::Uniform{0.3, 0.6}};  ///< nominal, decides when they meet [m/s]
  Distribution along_{Distribution::Uniform{0.2, 0.8}};        ///< where they meet: part of the way
  Distribution angle_{Distribution::Uniform{-0.5, 0.5}};       ///< off the square crossing or the way [rad]
  Distribution offset_{Distribution::Uniform{0.3, 1.2}};       ///< beside the way, for those that approach [m]
  double horizon_ = 60.0;                                      ///< start and witness are clear for so long [s]
  ObjectMix mix_;
};

}  // namespace

std::unique_ptr<const Family> read_moving(config::MapReader& in) { return std::make_unique<MovingFamily>(in); }

}  // namespace moma
