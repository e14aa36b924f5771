#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "controller/closed_form/closed_form.h"

namespace moma {
namespace {

constexpr double kSmallest = 0.02;  // s_min below which damping sets in
constexpr double kNothing = 1e-14;  // of the largest squared singular value: what is below is rounding

}  // namespace

void DampedInverse::update(const Matrix6X& J, double damping) noexcept {
  const Matrix6 JJt = J * J.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(JJt);
  const Vector6& values = eigen.eigenvalues();
  s_min_ = std::sqrt(std::max(values[0], 0.0));
  const double ratio = s_min_ / kSmallest;
  damping_squared_ = ratio < 1.0 ? damping * damping * (1.0 - ratio * ratio) : 0.0;
  Vector6 inverse;
  for (int i = 0; i < 6; ++i) {
    const double value = std::max(values[i], 0.0) + damping_squared_;
    inverse[i] = value > kNothing * values[5] ? 1.0 / value : 0.0;
  }
  inverse_.noalias() = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

void DampedInverse::apply(const Matrix6X& J, const Vector6& nu, VectorX& out) const noexcept {
  const Vector6 y = inverse_ * nu;
  out.noalias() = J.transpose() * y;
}

}  // namespace moma
