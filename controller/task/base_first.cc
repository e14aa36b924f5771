#include "controller/task/base_first.h"

#include <algorithm>
#include <cmath>

#include "controller/model/base_kind.h"
#include "controller/model/kinematics.h"
#include "controller/task/servo.h"

namespace moma {

BaseDrive drive_into_reach(const SeparateParams& params, const MobileBase& robot, const Vector3& base,
                           const Vector3& p_WG) noexcept {
  const BaseKind& kind = kind_of(robot.type);
  if (kind.dof() == 0) return {};
  const double ahead = bearing(base_pose(base), p_WG);
  const double left = (p_WG.head<2>() - base.head<2>()).norm() - params.reach;
  BaseDrive out;
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
