#include "controller/safe/base_ramp.h"

#include <algorithm>
#include <cmath>

namespace moma {
namespace {

// Ramps `velocity` towards velocity + change for dt, and returns the difference between end and mean. `change` becomes
// the achieved change.
template <class Vector>
Vector ramp(const Vector& velocity, double acceleration, const BaseRamp::Shares& shares, double dt,
            Vector& change) noexcept {
  const double size = change.norm();
  const double most = (velocity.dot(change) < 0.0 ? shares.slowing : shares.speeding) * acceleration * dt;
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
  const auto one = [](double x) { return One(x); };
  One turn = one(command[dof_ - 1] - velocity[dof_ - 1]);
  behind[dof_ - 1] = ramp(one(velocity[dof_ - 1]), acceleration_.y(), shares_, dt, turn)[0];
  if (dof_ == 3) {
    Vector2 linear = command.head<2>() - velocity.head<2>();
    behind.head<2>() = ramp<Vector2>(velocity.head<2>(), acceleration_.x(), shares_, dt, linear);
    velocity.head<2>() += linear;
  } else {
    One linear = one(command[0] - velocity[0]);
    behind[0] = ramp(one(velocity[0]), acceleration_.x(), shares_, dt, linear)[0];
    velocity[0] += linear[0];
  }
  velocity[dof_ - 1] += turn[0];
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
