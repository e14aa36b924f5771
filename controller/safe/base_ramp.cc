#include "controller/safe/base_ramp.h"

#include <algorithm>

namespace moma {
namespace {

// From u towards u + change for dt; returns how far the mean stays behind the end. `change` becomes what is made of it.
template <class Vector>
Vector ramp(double acceleration, double dt, Vector& change) noexcept {
  const double size = change.norm();
  const double most = acceleration * dt;
  if (!(size > 0.0)) return Vector::Zero(change.size());
  if (size > most) {
    change *= most / size;
    return 0.5 * change;
  }
  return (0.5 * size / most) * change;
}

}  // namespace

BaseRamp::BaseRamp(const RobotModel& model) : dof_(model.base_dof()), acceleration_(model.base.max_acceleration) {}

Vector3 BaseRamp::follow(const Vector3& command, double dt, Vector3& velocity) const noexcept {
  Vector3 behind = Vector3::Zero();
  if (dof_ == 0) return behind;
  using One = Eigen::Matrix<double, 1, 1>;
  One turn(command[dof_ - 1] - velocity[dof_ - 1]);
  behind[dof_ - 1] = ramp(acceleration_.y(), dt, turn)[0];
  if (dof_ == 3) {
    Vector2 linear = command.head<2>() - velocity.head<2>();
    behind.head<2>() = ramp(acceleration_.x(), dt, linear);
    velocity.head<2>() += linear;
  } else {
    One linear(command[0] - velocity[0]);
    behind[0] = ramp(acceleration_.x(), dt, linear)[0];
    velocity[0] += linear[0];
  }
  velocity[dof_ - 1] += turn[0];
  return velocity - behind;
}

double BaseRamp::stopping_time(const Vector3& velocity, double share) const noexcept {
  if (dof_ == 0) return 0.0;
  const double linear = dof_ == 3 ? velocity.head<2>().norm() : std::abs(velocity[0]);
  return std::max(linear / (share * acceleration_.x()), std::abs(velocity[dof_ - 1]) / (share * acceleration_.y()));
}

}  // namespace moma
