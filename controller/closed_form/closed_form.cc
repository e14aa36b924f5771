#include "controller/closed_form/closed_form.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "controller/model/base_kind.h"

namespace moma {
namespace {

constexpr double kSmallest = 0.02;  // s_min below which damping acts
constexpr double kNothing = 1e-14;  // relative to the largest squared singular value: smaller ones are rounding
constexpr double kInfluence = 0.9;  // distance below which a joint limit repels [rad, m]
constexpr double kStop = 0.05;      // distance at which the repulsion is 1 [rad, m]

double repulsion(double room) noexcept {
  if (!(room < kInfluence)) return 0.0;
  const double ratio = (room - kInfluence) / (kStop - kInfluence);
  return ratio * ratio;
}

}  // namespace

void DampedInverse::update(const Matrix6X& J, double damping) noexcept {
  const Matrix6 JJt = J * J.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(JJt);
  const Vector6& values = eigen.eigenvalues();
  const double s_min = std::sqrt(std::max(values[0], 0.0));
  const double ratio = s_min / kSmallest;
  const double damping_squared = ratio < 1.0 ? damping * damping * (1.0 - ratio * ratio) : 0.0;
  Vector6 inverse;
  for (int i = 0; i < 6; ++i) {
    const double value = std::max(values[i], 0.0) + damping_squared;
    inverse[i] = value > kNothing * values[5] ? 1.0 / value : 0.0;
  }
  inverse_.noalias() = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

void DampedInverse::apply(const Matrix6X& J, const Vector6& nu, VectorX& out) const noexcept {
  const Vector6 y = inverse_ * nu;
  out.noalias() = J.transpose() * y;
}

void add_projected(const DampedInverse& inverse, const Matrix6X& J, VectorX& gradient, VectorX& scratch,
                   VectorX& qdot) noexcept {
  const Vector6 task = J * gradient;
  inverse.apply(J, task, scratch);
  qdot += gradient - scratch;
}

void park_gradient(const ControllerParams& params, int base_dof, const VectorX& J_m, VectorX& gradient) noexcept {
  gradient.head(base_dof).setZero();
  gradient.tail(J_m.size()) = params.manipulability.weight * J_m.cwiseQuotient(params.lambda_q);
}

void add_limit_repulsion(const RobotModel& model, const VectorX& q, VectorX& gradient) noexcept {
  const int base_dof = model.base_dof();
  for (int i = 0; i < model.num_joints(); ++i) {
    const ControlledJoint& joint = model.joint(i);
    gradient[base_dof + i] += repulsion(q[i] - joint.lower) - repulsion(joint.upper - q[i]);
  }
}

void scale_into_limits(const RobotModel& model, const VectorX& speed, VectorX& qdot) noexcept {
  double factor = 1.0;
  for (Eigen::Index i = 0; i < qdot.size(); ++i) {
    const double size = std::abs(qdot[i]);
    if (size > speed[i]) factor = std::min(factor, speed[i] / size);
  }
  Eigen::Vector4d wheels;
  const int count = wheel_speeds(model.base, qdot, wheels);
  for (int i = 0; i < count; ++i) {
    const double size = std::abs(wheels[i]);
    if (size > model.base.wheels->max_speed) factor = std::min(factor, model.base.wheels->max_speed / size);
  }
  qdot *= factor;
  // Rounding of the product may exceed a limit by a last bit.
  qdot = qdot.cwiseMax(-speed).cwiseMin(speed);
}

}  // namespace moma
