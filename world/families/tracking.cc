#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "world/scenario/family.h"

namespace moma {
namespace {

constexpr double kStep = 0.1;  // between the times at which following is tried [s]

/// A goal that moves: to and fro on a line, on a circle, or along a spline. Solvable by construction: from the
/// witness on, the robot is shown to follow it for `follow` seconds within joint and velocity limits.
class TrackingFamily final : public Family {
 public:
  explicit TrackingFamily(config::MapReader& in) {
    const auto positive = config::Range::positive();
    placement_.tip_height = 0.3;
    placement_.read(in);
    in.read("line", weights_[0], config::Range::non_negative());
    in.read("circle", weights_[1], config::Range::non_negative());
    in.read("spline", weights_[2], config::Range::non_negative());
    in.check(weights_[0] + weights_[1] + weights_[2] > 0.0, "line", "one of line, circle, spline must be above 0");
    read(in, "speed", speed_, positive);
    read(in, "extent", extent_, positive);
    in.read("duration", duration_, positive);
    in.read("follow", follow_, config::Range::non_negative());
  }

  nlohmann::ordered_json to_json() const override {
    nlohmann::ordered_json out;
    placement_.write(out);
    out["line"] = weights_[0];
    out["circle"] = weights_[1];
    out["spline"] = weights_[2];
    out["speed"] = speed_.to_json();
    out["extent"] = extent_.to_json();
    out["duration"] = duration_;
    out["follow"] = follow_;
    return out;
  }

  bool build(SceneBuilder& builder, World& world) const override {
    if (!builder.place_robot(placement_, world)) return false;
    Draws draws = builder.draws(Stream::kMotion);
    const double speed = speed_.sample(draws);
    const double extent = extent_.sample(draws);
    const double kind = draws.uniform() * (weights_[0] + weights_[1] + weights_[2]);
    if (kind < weights_[0])
      world.goal.motion = line(draws, world.goal.X_WG.translation(), speed, extent);
    else if (kind < weights_[0] + weights_[1])
      world.goal.motion = circle(draws, builder.mobile(), world.goal.X_WG.translation(), speed, extent);
    else
      world.goal.motion = spline(draws, world.goal.X_WG.translation(), speed, extent);
    return follows(builder, world);
  }

 private:
  static Vector3 direction(Draws& draws) {
    const double z = draws.uniform(-1.0, 1.0);
    const double a = draws.uniform(-std::numbers::pi, std::numbers::pi);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(a), r * std::sin(a), z};
  }

  Motion line(Draws& draws, const Vector3& from, double speed, double extent) const {
    const Vector3 to = from + extent * direction(draws);
    PathMotion motion;
    const double leg = extent / speed;
    for (int k = 0; k * leg < duration_ + leg; ++k) {
      motion.times.push_back(k * leg);
      motion.positions.push_back(k % 2 == 0 ? from : to);
    }
    return motion;
  }

  Motion circle(Draws& draws, bool mobile, const Vector3& from, double speed, double extent) const {
    const double radius = 0.5 * extent;
    const double rate = speed / radius;
    const Vector3 axis = direction(draws);
    const double side = draws.uniform(-std::numbers::pi, std::numbers::pi);
    if (mobile) {  // it turns with the circle, and the base with it
      const Vector3 center = from + extent * Vector3(std::cos(side), std::sin(side), 0.0);
      return CircleMotion{center, Vector3::UnitZ(), axis.z() < 0.0 ? -0.5 * rate : 0.5 * rate};
    }
    // An arm on a fixed base cannot turn for ever: the orientation stays.
    const Vector3 u = axis.unitOrthogonal();
    const Vector3 v = axis.cross(u);
    const auto at = [&](double angle) -> Vector3 { return radius * (std::cos(angle) * u + std::sin(angle) * v); };
    constexpr double kKnots = 16.0;  // per turn
    SplineMotion motion;
    const double leg = 2.0 * std::numbers::pi / (kKnots * rate);
    for (int k = 0; k * leg < duration_ + leg; ++k) {
      motion.times.push_back(k * leg);
      motion.positions.emplace_back(from + at(side + 2.0 * std::numbers::pi * k / kKnots) - at(side));
    }
    return motion;
  }

  Motion spline(Draws& draws, const Vector3& from, double speed, double extent) const {
    SplineMotion motion;
    motion.times = {0.0};
    motion.positions = {from};
    while (motion.times.back() < duration_) {
      const Vector3 to = from + 0.5 * extent * draws.uniform(0.3, 1.0) * direction(draws);
      motion.times.push_back(motion.times.back() + std::max((to - motion.positions.back()).norm(), 0.05) / speed);
      motion.positions.push_back(to);
    }
    return motion;
  }

  bool follows(SceneBuilder& builder, const World& world) const {
    const RobotModel& model = builder.model();
    Kinematics kinematics(builder.model_pointer());
    Configuration at = world.witness;
    const VectorX most = model.velocity_limits() * kStep;
    for (int k = 1; k * kStep <= follow_; ++k) {
      const Configuration before = at;
      const MovingPose goal = evaluate(world.goal.motion, world.goal.X_WG, k * kStep);
      if (goal.X.translation().z() < placement_.tip_height) return builder.reject("tracking: the path leads too low");
      VectorX moved = VectorX::Zero(model.num_velocities());
      if (!reach(kinematics, goal.X, at, moved)) return builder.reject("tracking: the path leads out of reach");
      for (Eigen::Index i = 0; i < moved.size(); ++i)
        if (std::abs(moved[i]) > most[i]) return builder.reject("tracking: too fast to follow (speed)");
      for (int j = 0; j < model.num_joints(); ++j)
        if (at.q[j] < model.joints[static_cast<std::size_t>(j)].lower ||
            at.q[j] > model.joints[static_cast<std::size_t>(j)].upper)
          return builder.reject("tracking: following it ends at a joint limit");
      if (k % 5 == 0 && !builder.check_configuration(at, placement_)) return false;
    }
    return true;
  }

  /// Damped least squares from the configuration before; `moved` sums up the steps.
  static bool reach(Kinematics& kinematics, const Isometry& goal, Configuration& at, VectorX& moved) {
    constexpr double kDamping = 1e-3;
    for (int i = 0; i < 20; ++i) {
      kinematics.update(at.base, at.q);
      Vector6 e;
      e << log_so3(goal.linear() * kinematics.X_WE().linear().transpose()),
          goal.translation() - kinematics.X_WE().translation();
      if (e.head<3>().norm() < 0.005 && e.tail<3>().norm() < 0.002) return true;
      const Matrix6X& J = kinematics.J_WE_W();
      const Eigen::Matrix<double, 6, 6> A = J * J.transpose() + kDamping * Eigen::Matrix<double, 6, 6>::Identity();
      const VectorX step = J.transpose() * A.ldlt().solve(e);
      integrate(kinematics.model(), at.base, at.q, step, 1.0);
      moved += step;
    }
    return false;
  }

  Placement placement_;
  std::array<double, 3> weights_{1.0, 1.0, 1.0};           ///< of line, circle, spline
  Distribution speed_{Distribution::Uniform{0.05, 0.15}};  ///< of the goal [m/s]
  Distribution extent_{Distribution::Uniform{0.2, 0.6}};   ///< length of the line, diameter, reach of the spline [m]
  double duration_ = 60.0;                                 ///< then line and spline rest [s]
  double follow_ = 30.0;                                   ///< shown to be followed for so long [s]
};

}  // namespace

std::unique_ptr<const Family> read_tracking(config::MapReader& in) { return std::make_unique<TrackingFamily>(in); }

}  // namespace moma
