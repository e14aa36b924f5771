#include "controller/safe/base_ramp.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace moma {

BaseRamp::BaseRamp(const RobotModel& model) : dof_(model.base_dof()), acceleration_(model.base.max_acceleration) {}

Vector3 BaseRamp::follow(const Vector3& command, double dt, Vector3& velocity) const noexcept {
  Vector3 behind = Vector3::Zero();  // difference between end and mean
  const auto ramp = [&]<int n>(std::integral_constant<int, n>, int first, double acceleration) {
    auto now = velocity.segment<n>(first);
    Eigen::Matrix<double, n, 1> change = command.segment<n>(first) - now;
    const double size = change.norm();
    const double most = (now.dot(change) < 0.0 ? shares_.slowing : shares_.speeding) * acceleration * dt;
    if (size > most) change *= most / size;
    if (size > 0.0) behind.segment<n>(first) = (size > most ? 0.5 : 0.5 * size / most) * change;
    now += change;
  };
  constexpr std::integral_constant<int, 1> kOne{};
  if (dof_ == 0) return behind;
  if (dof_ == 3)
    ramp(std::integral_constant<int, 2>{}, 0, acceleration_.x());
  else
    ramp(kOne, 0, acceleration_.x());
  ramp(kOne, dof_ - 1, acceleration_.y());
  return velocity - behind;
}

Vector3 BaseRamp::limited(const Vector3& command, const Vector3& before, double share, double dt) const noexcept {
  if (dof_ == 0) return command;
  Vector3 out = command;
  // Differences by rounding alone are ignored.
  const auto part = [&](double change, double acceleration) {
    const double most = share * acceleration * dt;
    return change > most * (1.0 + 1e-9) ? most / change : 1.0;
  };
  const Vector3 change = command - before;
  const double linear = dof_ == 3 ? change.head<2>().norm() : std::abs(change[0]);
  const double along = part(linear, acceleration_.x());
  const double turn = part(std::abs(change[dof_ - 1]), acceleration_.y());
  if (along < 1.0) out.head(dof_ - 1) = before.head(dof_ - 1) + along * change.head(dof_ - 1);
  if (turn < 1.0) out[dof_ - 1] = before[dof_ - 1] + turn * change[dof_ - 1];
  return out;
}

double BaseRamp::stopping_time(const Vector3& velocity, double share) const noexcept {
  if (dof_ == 0) return 0.0;
  const double linear = dof_ == 3 ? velocity.head<2>().norm() : std::abs(velocity[0]);
  const double part = share * shares_.slowing;
  return std::max(linear / (part * acceleration_.x()), std::abs(velocity[dof_ - 1]) / (part * acceleration_.y()));
}

}  // namespace moma
