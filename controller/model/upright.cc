#include "controller/model/upright.h"

#include <algorithm>
#include <cmath>

namespace moma {

double tilt(const Upright& upright, const Matrix3& R_WE) noexcept {
  const Vector3 u = R_WE * upright.axis;
  return std::atan2(std::hypot(u.x(), u.y()), u.z());
}

double tilt(const Upright& upright, const Kinematics& kinematics) noexcept {
  const RobotModel& model = kinematics.model();
  return tilt(upright, kinematics.X_WL(model.tip).linear() * model.X_TE.linear());
}

Vector3 tilt_direction(const Upright& upright, const Matrix3& R_WE) noexcept {
  constexpr double kVertical = 1e-9;
  const Vector3 u = R_WE * upright.axis;
  const double across = std::hypot(u.x(), u.y());
  return across > kVertical * u.norm() ? Vector3(-u.y() / across, u.x() / across, 0.0) : Vector3::Zero();
}

int bring_upright(const Upright& upright, double aim, const Eigen::Ref<const VectorX>& lower,
                  const Eigen::Ref<const VectorX>& upper, Kinematics& kinematics, Eigen::Ref<VectorX> q) noexcept {
  constexpr int kMost = 12;
  constexpr double kWithin = 1e-3;  // [rad]
  for (int i = 1; i <= kMost; ++i) {
    const Vector3 base = kinematics.base();
    kinematics.update(base, q);
    const double over = tilt(upright, kinematics) - aim;
    if (over <= kWithin) return i;
    const Vector3 m = tilt_direction(upright, kinematics.X_WE().linear());
    const auto J = kinematics.J_WE_W().rightCols(q.size());
    double square = 1e-6;
    for (Eigen::Index j = 0; j < q.size(); ++j) square += std::pow(m.dot(J.col(j).head<3>()), 2);
    for (Eigen::Index j = 0; j < q.size(); ++j)
      q[j] = std::clamp(q[j] - m.dot(J.col(j).head<3>()) * over / square, lower[j], upper[j]);
  }
  return -1;
}

}  // namespace moma
