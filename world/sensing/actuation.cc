#include "world/sensing/actuation.h"

#include <cmath>

namespace moma {
namespace {

// Steps from `from` towards `to`, n coordinates as one vector: while slowing down by at most `down`, then by at most
// `up`.
template <int n>
Eigen::Matrix<double, n, 1> ramped(const Eigen::Matrix<double, n, 1>& from, const Eigen::Matrix<double, n, 1>& to,
                                   double up, double down) {
  const Eigen::Matrix<double, n, 1> change = to - from;
  const double size = change.norm();
  if (!(size > 0.0)) return to;
  const bool slower = to.norm() < from.norm() || from.dot(to) < 0.0;
  const double most = slower ? down : up;
  return size <= most ? to : Eigen::Matrix<double, n, 1>(from + most / size * change);
}

}  // namespace

Actuation::Actuation(const Disturbances& disturbances, const RobotModel& model, const World& world,
                     double control_period)
    : streams_(world, disturbances.seed),
      errors_(disturbances.actuators),
      acceleration_(model.base.max_acceleration),
      dt_(control_period),
      base_dof_(model.base_dof()),
      factor_(VectorX::Ones(model.num_velocities())),
      lagging_(VectorX::Zero(model.num_velocities())),
      base_(VectorX::Zero(base_dof_)),
      joints_(VectorX::Zero(model.num_joints())),
      applied_(VectorX::Zero(model.num_velocities())),
      late_base_(errors_.base.delay, errors_.base.irregularity, control_period, base_, BeforeFirst::kPrototype),
      late_joints_(errors_.joints.delay, errors_.joints.irregularity, control_period, joints_,
                   BeforeFirst::kPrototype) {
  using enum DisturbanceSource;
  const Actuators& errors = errors_;
  const DisturbanceStreams& streams = streams_;
  Draws linear = streams.acting(kBaseLinearGain);
  for (int i = 0; i + 1 < base_dof_; ++i) factor_[i] += linear.normal(0.0, errors.base.gain_error.linear);
  if (base_dof_ > 0)
    factor_[base_dof_ - 1] += streams.acting(kBaseAngularGain).normal(0.0, errors.base.gain_error.angular);
  Draws joints = streams.acting(kJointGain);
  for (Eigen::Index i = base_dof_; i < factor_.size(); ++i) factor_[i] += joints.normal(0.0, errors.joints.gain_error);
  factor_ = factor_.cwiseMax(0.0);
}

const VectorX& Actuation::act(long k, const VectorX& command) {
  base_ = command.head(base_dof_);
  joints_ = command.tail(joints_.size());
  using enum DisturbanceSource;
  late_base_.pass(k, base_, [&] { return streams_.acting(kBaseCommandArrival, k); });
  late_joints_.pass(k, joints_, [&] { return streams_.acting(kJointCommandArrival, k); });
  if (!is_off(errors_.base.deadband) && base_dof_ > 0) {
    const int linear = base_dof_ - 1;
    if (base_.head(linear).norm() <= errors_.base.deadband.linear) base_.head(linear).setZero();
    if (std::abs(base_[linear]) <= errors_.base.deadband.angular) base_[linear] = 0.0;
  }
  applied_.head(base_dof_) = base_;
  applied_.tail(joints_.size()) = joints_;
  applied_.array() *= factor_.array();
  lag_behind();
  if (!is_off(errors_.base.ramps) && base_dof_ > 0) {
    Vector3 wanted = Vector3::Zero();
    for (int i = 0; i < base_dof_; ++i) wanted[i + 1 == base_dof_ ? 2 : i] = applied_[i];
    follow(wanted);
    for (int i = 0; i < base_dof_; ++i) applied_[i] = followed_[i + 1 == base_dof_ ? 2 : i];
  }
  return applied_;
}

void Actuation::lag_behind() {
  for (Eigen::Index i = 0; i < applied_.size(); ++i) {
    const double lag = i < base_dof_ ? errors_.base.lag : errors_.joints.lag;
    if (!(lag > 0.0)) continue;
    const double behind = lagging_[i] - applied_[i];
    lagging_[i] = applied_[i] + behind * std::exp(-dt_ / lag);
    applied_[i] -= behind * lag / dt_ * std::expm1(-dt_ / lag);
  }
}

// (v_x, v_y, omega); v_y is unused for a differential base.
void Actuation::follow(const Vector3& wanted) {
  const BaseRamps& part = errors_.base.ramps;
  const Vector2 most = dt_ * acceleration_;
  followed_.head<2>() =
      ramped<2>(followed_.head<2>(), wanted.head<2>(), part.speed_up * most.x(), part.slow_down * most.x());
  const Eigen::Matrix<double, 1, 1> turn(followed_.z()), turn_to(wanted.z());
  followed_.z() = ramped<1>(turn, turn_to, part.speed_up * most.y(), part.slow_down * most.y())[0];
}

}  // namespace moma
