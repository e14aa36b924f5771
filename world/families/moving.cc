#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "world/scenario/family.h"
#include "world/scenario/object_mix.h"
#include "world/scenario/walk.h"

namespace moma {
namespace {

constexpr int kObjectTries = 200;

/// Solids that move through the robot's way: some cross it in a straight line at about the time when the robot is
/// there, some come along it from the far side, some go round in circles beside it or around the goal, and people walk
/// about. Their whole path over `horizon` is clear of start and witness, so a robot that waits is not run over, and one
/// that has arrived can stay.
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
    in.read("horizon", horizon_, {0.0, 3600.0, true, false});
    mix_.read(in);
    in.read("orbit", orbit_, {0.0, 1.0});
    in.read("walk", walk_, {0.0, 1.0});
    in.check(orbit_ + walk_ <= 1.0 + 1e-12, "orbit", "orbit and walk are parts of the objects: at most 1 together");
    read(in, "orbit_radius", orbit_radius_, {0.05, 1000.0});
    in.read("orbit_goal", orbit_goal_, {0.0, 1.0});
    walker_.read(in);
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
    // Without them nothing is said of them: what was stored before there were any keeps its keys.
    if (orbit_ > 0.0) {
      out["orbit"] = orbit_;
      out["orbit_radius"] = orbit_radius_.to_json();
      out["orbit_goal"] = orbit_goal_;
    }
    if (walk_ > 0.0) {
      out["walk"] = walk_;
      walker_.write(out);
    }
    return out;
  }

  bool build(SceneBuilder& builder, World& world) const override {
    if (!builder.place_robot(placement_, world)) return false;
    Draws number = builder.draws(Stream::kObjects);
    const int count = objects_.sample_count(number);
    const Way way = straight_way(builder, world);
    // What an object does is kept over its tries: else what fits in badly would come less often than it was asked for.
    Draws kinds = builder.draws(Stream::kMotion, 0);
    for (int i = 0; i < count; ++i) {
      const double kind = kinds.uniform();
      const bool around_goal = kinds.uniform() < orbit_goal_;
      const bool walks = kind >= 1.0 - walk_;
      WorldObject object;
      object.name = (walks ? "walker" : "object") + std::to_string(i + 1);
      bool placed = false;
      for (int k = 0; k < kObjectTries && !placed; ++k) {
        const auto item = 1 + static_cast<std::uint64_t>(i * kObjectTries + k);
        if (walks)
          placed = walker_.sample(builder, way, mix_, horizon_, item, object);
        else if (kind < orbit_)
          placed = circle(builder, world, way, around_goal, item, object);
        else
          placed = straight(builder, way, item, object);
        if (!placed) builder.drawn_again("a path not clear of start and goal");
      }
      if (!placed) return builder.reject("objects: no path clear of start and goal (worlds.clearance)");
      world.objects.push_back(std::move(object));
    }
    return true;
  }

 private:
  static Way straight_way(const SceneBuilder& builder, const World& world) {
    Way out;
    out.from = builder.mobile() ? Vector3(world.start.base.x(), world.start.base.y(), 0.0) : builder.start_tip();
    Vector3 way = world.goal.X_WG.translation() - out.from;
    way.z() = 0.0;
    out.length = way.norm();
    if (out.length > 1e-6) out.forward = way / out.length;
    return out;
  }

  /// One object that crosses or approaches. False where its path is not clear.
  bool straight(SceneBuilder& builder, const Way& way, std::uint64_t item, WorldObject& object) const {
    Draws draws = builder.draws(Stream::kMotion, item);
    const bool crosses = draws.uniform() < crossing_;
    const double speed = speed_.sample(draws);
    const double robot_speed = robot_speed_.sample(draws);
    const double along = along_.sample(draws);
    const double angle = angle_.sample(draws);
    const double offset = offset_.sample(draws);
    const double side = draws.uniform() < 0.5 ? -1.0 : 1.0;

    // Where object and robot would meet, the robot going straight at its nominal speed.
    const double meeting_time = along * way.length / robot_speed;
    Vector3 meeting = way.from + along * way.length * way.forward;
    Vector3 heading = side * way.left();
    if (!crosses) {
      heading = -way.forward;
      meeting += side * offset * way.left();
    }
    const Vector3 direction = Eigen::AngleAxisd(angle, Vector3::UnitZ()) * heading;
    const Vector3 begin = meeting - speed * meeting_time * direction;

    Draws solid = builder.draws(Stream::kObjects, item);
    mix_.sample(solid, begin.x(), begin.y(), object);
    LinearMotion motion;
    motion.V_W.tail<3>() = speed * direction;
    object.motion = motion;
    return builder.clear_for(object, speed, horizon_, builder.clearance());
  }

  /// One object that goes round in a circle, turning with it. False where its path is not clear.
  bool circle(SceneBuilder& builder, const World& world, const Way& way, bool around_goal, std::uint64_t item,
              WorldObject& object) const {
    Draws draws = builder.draws(Stream::kMotion, item);
    const double speed = speed_.sample(draws);
    const double radius = orbit_radius_.sample(draws);
    const double along = along_.sample(draws);
    const double offset = offset_.sample(draws);
    const double side = draws.uniform() < 0.5 ? -1.0 : 1.0;
    const double sense = draws.uniform() < 0.5 ? -1.0 : 1.0;
    const double phase = draws.uniform(-std::numbers::pi, std::numbers::pi);

    Vector3 center = way.from + along * way.length * way.forward + side * offset * way.left();
    if (around_goal) center = world.goal.X_WG.translation();
    Draws solid = builder.draws(Stream::kObjects, item);
    mix_.sample(solid, center.x() + radius * std::cos(phase), center.y() + radius * std::sin(phase), object);
    center.z() = object.X_WO.translation().z();
    const double rate = speed / radius;
    object.motion = CircleMotion{center, Vector3::UnitZ(), sense * rate};
    // Its outermost point is the fastest; once round is all there is.
    const double fastest = rate * (radius + bounding_radius(object.shape));
    const double once = rate > 0.0 ? std::min(horizon_, 2.0 * std::numbers::pi / rate) : 0.0;
    const double between = fastest * SceneBuilder::kTimeStep;
    return builder.clear_for(object, fastest, once, builder.clearance() + between);
  }

  Placement placement_;
  Distribution objects_{Distribution::Uniform{1.0, 4.0}};
  double crossing_ = 0.5;                                ///< part of the straight ones that cross; the others approach
  Distribution speed_{Distribution::Uniform{0.1, 0.5}};  ///< [m/s]
  Distribution robot_speed_{Distribution::Uniform{0.3, 0.6}};   ///< nominal, decides when they meet [m/s]
  Distribution along_{Distribution::Uniform{0.2, 0.8}};         ///< where they meet: part of the way
  Distribution angle_{Distribution::Uniform{-0.5, 0.5}};        ///< off the square crossing or the way [rad]
  Distribution offset_{Distribution::Uniform{0.3, 1.2}};        ///< beside the way: those that approach, circles [m]
  double horizon_ = 60.0;                                       ///< start and witness are clear for so long [s]
  double orbit_ = 0.0;                                          ///< part of the objects that go round in circles
  double walk_ = 0.0;                                           ///< part of the objects that walk
  Distribution orbit_radius_{Distribution::Uniform{0.5, 2.0}};  ///< [m]
  double orbit_goal_ = 0.5;  ///< part of the circles around the goal; the others are `offset` beside the way
  ObjectMix mix_;
  Walk walker_;
};

}  // namespace

std::unique_ptr<const Family> read_moving(config::MapReader& in) { return std::make_unique<MovingFamily>(in); }

}  // namespace moma
