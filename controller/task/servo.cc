#include "controller/task/servo.h"

#include <algorithm>
#include <cmath>

#include "controller/model/base_kind.h"
#include "controller/model/kinematics.h"

namespace moma {
namespace {

Vector3 clamped(const Vector3& v, double limit) noexcept {
  const double length = v.norm();
  return length > limit ? Vector3(v * (limit / length)) : v;
}

}  // namespace

Vector6 pose_error_rpy(const Isometry& X_WE, const Isometry& X_WG) noexcept {
  Vector6 e;
  e.head<3>() = X_WE.linear() * rpy_of(X_WE.linear().transpose() * X_WG.linear());
  e.tail<3>() = X_WG.translation() - X_WE.translation();
  return e;
}

Vector6 servo_twist(const ServoParams& params, const Vector6& error, const Vector6& V_WG_W) noexcept {
  Vector6 nu;
  nu.head<3>() = clamped(params.orientation * error.head<3>(), params.max_angular);
  nu.tail<3>() = clamped(params.position * error.tail<3>(), params.max_linear);
  return nu + V_WG_W;
}

Vector6 passing_twist(const ServoParams& params, const Vector6& error, const Vector6& V_WG_W) noexcept {
  constexpr double kLever = 0.3;  // [m/rad]
  const double left = std::max(error.tail<3>().norm(), kLever * error.head<3>().norm());
  return servo_twist(
      params, (left < params.pass_from ? std::min(params.pass_from / left, params.pass_factor) : 1.0) * error, V_WG_W);
}

double error_norm(const ErrorNormParams& params, const Vector6& error) noexcept {
  switch (params.kind) {
    case ErrorNormKind::kEuclidean:
      return error.tail<3>().norm();
    case ErrorNormKind::kL1:
      return error.tail<3>().lpNorm<1>();
    case ErrorNormKind::kPose:
      return std::sqrt(error.tail<3>().squaredNorm() + params.scale * params.scale * error.head<3>().squaredNorm());
  }
  return 0.0;
}

double bearing(const Isometry& X_WB, const Vector3& p_W) noexcept {
  const Vector3 p_B = X_WB.linear().transpose() * (p_W - X_WB.translation());
  return std::atan2(p_B.y(), p_B.x());
}

DriveIntoReach drive_into_reach(const BaseFirstParams& params, const MobileBase& robot, const Vector3& base,
                                const Vector3& p_WG) noexcept {
  const BaseKind& kind = kind_of(robot.type);
  if (kind.dof() == 0) return {};
  const double ahead = bearing(base_pose(base), p_WG);
  const double left = (p_WG.head<2>() - base.head<2>()).norm() - params.reach;
  DriveIntoReach out;
  out.driving = std::abs(left) > params.tolerance || std::abs(ahead) > params.bearing;
  if (!out.driving) return out;
  const double speed = std::clamp(params.gain * left, -robot.max_linear, robot.max_linear);
  if (kind.nonholonomic()) {
    out.velocity_B.x() = speed * std::max(0.0, std::cos(ahead));
  } else {
    out.velocity_B.head<2>() = speed * Vector2(std::cos(ahead), std::sin(ahead));
  }
  out.velocity_B.z() = std::clamp(params.gain * ahead, -robot.max_angular, robot.max_angular);
  return out;
}

}  // namespace moma
