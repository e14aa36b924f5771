#include <algorithm>
#include <cmath>
#include <numbers>

#include "world/scenario/family.h"

namespace moma {
namespace {

constexpr double kStep = 0.1;  // interval between two checks of following [s]

/// A moving goal: to and fro on a line, on a circle, or along a spline. Solvable by construction: starting at the
/// witness, the robot is shown to follow it for `follow` seconds within joint and velocity limits.
struct Tracking {
  using Uniform = Distribution::Uniform;
  Placement placement{.tip_height = 0.3};
  double line = 1.0;
  double circle = 1.0;
  double spline = 1.0;
  Distribution speed{Uniform{0.05, 0.15}};  ///< [m/s]
  Distribution extent{Uniform{0.2, 0.6}};   ///< [m]
  double duration = 60.0;                   ///< [s]
  double follow = 30.0;                     ///< [s]
};

constexpr void describe(auto& v, Of<Tracking>) {
  using T = Tracking;
  constexpr Range kWeight = Range::non_negative();
  v.inlined(&T::placement);
  v.member("line", &T::line, in_range(kWeight, "", "weight of goals that move to and fro on a line"));
  v.member("circle", &T::circle, in_range(kWeight, "", "weight of goals on a circle"));
  v.member("spline", &T::spline, in_range(kWeight, "", "weight of goals along a spline"));
  v.member("speed", &T::speed, positive("m/s", "speed of the goal"));
  v.member("extent", &T::extent, positive("m", "length of the line, diameter of the circle, extent of the spline"));
  v.member("duration", &T::duration, positive("s", "time after which line and spline rest"));
  v.member("follow", &T::follow, non_negative("s", "time for which the goal is shown to be followed"));
}

void check(const Tracking& p, const config::MapReader& in) {
  in.check(p.line + p.circle + p.spline > 0.0, "line", "one of line, circle, spline must be above 0");
}

Vector3 direction(Draws& draws) {
  const double z = draws.uniform(-1.0, 1.0);
  const double a = draws.uniform(-std::numbers::pi, std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(a), r * std::sin(a), z};
}

Motion line(const Tracking& p, Draws& draws, const Vector3& from, double speed, double extent) {
  const Vector3 to = from + extent * direction(draws);
  return to_and_fro(from, to, extent / speed, p.duration);
}

Motion circle(const Tracking& p, Draws& draws, bool mobile, const Vector3& from, double speed, double extent) {
  const double radius = 0.5 * extent;
  const double rate = speed / radius;
  const Vector3 axis = direction(draws);
  const double side = draws.uniform(-std::numbers::pi, std::numbers::pi);
  if (mobile) {  // the goal turns with the circle, and the base with it
    const Vector3 center = from + extent * Vector3(std::cos(side), std::sin(side), 0.0);
    return CircleMotion{center, Vector3::UnitZ(), axis.z() < 0.0 ? -0.5 * rate : 0.5 * rate};
  }
  // An arm on a fixed base cannot turn indefinitely: the orientation is constant.
  const Vector3 u = axis.unitOrthogonal();
  const Vector3 v = axis.cross(u);
  const auto at = [&](double angle) -> Vector3 { return radius * (std::cos(angle) * u + std::sin(angle) * v); };
  constexpr double kKnots = 16.0;  // knots per turn
  SplineMotion motion;
  const double leg = 2.0 * std::numbers::pi / (kKnots * rate);
  for (int k = 0; k * leg < p.duration + leg; ++k) {
    motion.times.push_back(k * leg);
    motion.positions.emplace_back(from + at(side + 2.0 * std::numbers::pi * k / kKnots) - at(side));
  }
  return motion;
}

Motion spline(const Tracking& p, Draws& draws, const Vector3& from, double speed, double extent) {
  SplineMotion motion;
  motion.times = {0.0};
  motion.positions = {from};
  while (motion.times.back() < p.duration) {
    const Vector3 to = from + 0.5 * extent * draws.uniform(0.3, 1.0) * direction(draws);
    motion.times.push_back(motion.times.back() + std::max((to - motion.positions.back()).norm(), 0.05) / speed);
    motion.positions.push_back(to);
  }
  return motion;
}

/// Damped least squares from the configuration before; adds the joint motion to `moved`.
bool reach(Kinematics& kinematics, const Isometry& goal, Configuration& at, VectorX& moved) {
  constexpr double kDamping = 1e-3;
  for (int i = 0; i < 20; ++i) {
    kinematics.update(at.base, at.q);
    const Vector6 e = pose_error(kinematics.X_WE(), goal);
    if (e.head<3>().norm() < 0.005 && e.tail<3>().norm() < 0.002) return true;
    const Matrix6X& J = kinematics.J_WE_W();
    const Eigen::Matrix<double, 6, 6> A = J * J.transpose() + kDamping * Eigen::Matrix<double, 6, 6>::Identity();
    const VectorX step = J.transpose() * A.ldlt().solve(e);
    integrate(kinematics.model(), at.base, at.q, step, 1.0);
    moved += step;
  }
  return false;
}

bool follows(const Tracking& p, SceneBuilder& builder, const World& world) {
  const RobotModel& model = builder.model();
  Kinematics kinematics(builder.model_pointer());
  Configuration at = world.witness;
  const VectorX most = model.velocity_limits() * kStep;
  for (int k = 1; k * kStep <= p.follow; ++k) {
    const Configuration before = at;
    const MovingPose goal = evaluate(world.goal.motion, world.goal.X_WG, k * kStep);
    if (goal.X.translation().z() < p.placement.tip_height) return builder.reject("tracking: the path leads too low");
    VectorX moved = VectorX::Zero(model.num_velocities());
    if (!reach(kinematics, goal.X, at, moved)) return builder.reject("tracking: the path leads out of reach");
    for (Eigen::Index i = 0; i < moved.size(); ++i)
      if (std::abs(moved[i]) > most[i]) return builder.reject("tracking: too fast to follow (speed)");
    for (int j = 0; j < model.num_joints(); ++j)
      if (at.q[j] < model.joint(j).lower || at.q[j] > model.joint(j).upper)
        return builder.reject("tracking: following it ends at a joint limit");
    if (k % 5 == 0 && !builder.check_configuration(at, p.placement)) return false;
  }
  return true;
}

bool build(const Tracking& p, SceneBuilder& builder, World& world) {
  if (!builder.place_robot(p.placement, world)) return false;
  Draws draws = builder.draws(Stream::kMotion);
  const double speed = p.speed.sample(draws);
  const double extent = p.extent.sample(draws);
  const double kind = draws.uniform() * (p.line + p.circle + p.spline);
  if (kind < p.line)
    world.goal.motion = line(p, draws, world.goal.X_WG.translation(), speed, extent);
  else if (kind < p.line + p.circle)
    world.goal.motion = circle(p, draws, builder.mobile(), world.goal.X_WG.translation(), speed, extent);
  else
    world.goal.motion = spline(p, draws, world.goal.X_WG.translation(), speed, extent);
  return follows(p, builder, world);
}

}  // namespace

FamilyType tracking_family() {
  return family_type<Tracking>(
      "a goal that moves on a line, a circle or a spline, shown to be followed within joint and velocity limits");
}

}  // namespace moma
