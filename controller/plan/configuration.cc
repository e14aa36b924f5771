#include "controller/plan/configuration.h"

#include <algorithm>

#include "controller/map/gaze.h"

namespace moma {
namespace {

// Reach of E and the links after a joint: their summed lengths times kBent, since arms are rarely straight.
constexpr double kBent = 0.7;
constexpr double kLongest = 1.0;
constexpr double kHand = 0.05;
// Tolerance for limits of -pi and pi as rounded in files [rad].
constexpr double kRounded = 1e-3;

double lever_of(const RobotModel& model, const ControlledJoint& joint) {
  if (joint.type == JointType::kPrismatic) return kBent;
  double length = model.X_TE.translation().norm() + kHand;
  for (int link = model.tip; link != joint.link && link > 1; link = model.link(link).parent)
    length += model.link(link).X_PJ.translation().norm();
  return kBent * std::min(length, kLongest);
}

// Returns the share of the base's speeds at which no wheel is too fast, in every direction. A base that drives along
// its heading does not turn meanwhile.
double wheels_part(const MobileBase& base) {
  const BaseKind& kind = kind_of(base.type);
  if (!base.wheels || !kind.lateral()) return 1.0;
  const Wheels& w = *base.wheels;
  double fastest = 0.0;  // of a wheel's rim [m/s]
  for (int i = 0; i < static_cast<int>(kind.wheel_names.size()); ++i) {
    const Vector3 row = w.radius * kind.wheel_row(w, i);
    fastest = std::max(fastest, row.head<2>().norm() * base.max_linear + std::abs(row.z()) * base.max_angular);
  }
  fastest /= w.radius;
  return fastest > w.max_speed ? w.max_speed / fastest : 1.0;
}

}  // namespace

MotionLimits::MotionLimits(const RobotModel& model, const ControllerParams& params)
    : base(&kind_of(model.base.type)), winds(model.num_joints()) {
  lower = upper = margin = part = joint_speed = joint_acceleration = lever = VectorX::Zero(model.num_joints());
  const PlanParams& plan = params.plan;
  const int first = model.base_dof();
  for (int i = 0; i < model.num_joints(); ++i) {
    const ControlledJoint& joint = model.joint(i);
    lower[i] = joint.lower;
    upper[i] = joint.upper;
    part[i] = limit_part(joint);
    margin[i] = std::min(part[i] * plan.joint_margin, 0.4 * (upper[i] - lower[i]));
    winds[i] = joint.type != JointType::kPrismatic && upper[i] - lower[i] > kFullTurn + kRounded ? 1 : 0;
    joint_speed[i] = plan.speed * joint.velocity;
    joint_acceleration[i] = plan.acceleration * params.acceleration_limit[first + i];
    lever[i] = lever_of(model, joint);
  }
  const double fast = plan.speed * wheels_part(model.base);
  linear = fast * model.base.max_linear;
  angular = fast * model.base.max_angular;
  if (model.base.wheels && base->nonholonomic()) {
    rim_speed = plan.speed * model.base.wheels->radius * model.base.wheels->max_speed;
    half_track = 0.5 * model.base.wheels->separation;
  }
  const UnseenParams& unseen = params.map.unseen;
  if (params.map.enabled && unseen.enabled && unseen.facing > 0.0 && base->nonholonomic() && !looks_behind(model))
    facing = unseen.facing;
  double a_linear = model.base.max_acceleration[0], a_angular = model.base.max_acceleration[1];
  if (first > 0) {
    a_linear = std::min(a_linear, params.acceleration_limit[0]);
    a_angular = std::min(a_angular, params.acceleration_limit[first - 1]);
  }
  capability = plan.acceleration * Vector2(a_linear, a_angular);
  set_drive(1.0);
}

double MotionLimits::travel(const WholeConfiguration& change) const noexcept {
  const WholeConfiguration way = change.cwiseAbs();
  return way.head<2>().norm() + base_lever * way[2] + way.tail(num_joints()).dot(lever);
}

double MotionLimits::distance_squared(const Eigen::Ref<const VectorX>& a, const WholeConfiguration& b) const noexcept {
  constexpr double kTurn = 0.3, kJoints = 0.5;
  double joints = 0.0;
  for (int i = 0; i < num_joints(); ++i) {
    const double way = lever[i] * (a[3 + i] - b[3 + i]);
    joints += way * way;
  }
  const double turn = kTurn * wrapped(a[2] - b[2]);
  const double x = a[0] - b[0], y = a[1] - b[1];
  return x * x + y * y + turn * turn + kJoints * kJoints * joints;
}

}  // namespace moma
