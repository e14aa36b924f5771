#pragma once

#include "controller/params.h"
#include "controller/types.h"

namespace moma {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Damped least-squares inverse J^T (J J^T + lambda^2 I)^-1 with lambda^2 = damping^2 (1 - (s_min/0.02)^2) where the
/// smallest singular value s_min is below 0.02, else 0 (Nakamura & Hanafusa, ASME JDSMC 108, 1986). Without damping the
/// pseudo-inverse: directions whose singular value is below 1e-7 of the largest are left out. No allocation.
class DampedInverse {
 public:
  /// J is 6 x num_velocities, finite; damping >= 0.
  void update(const Matrix6X& J, double damping) noexcept;
  /// J^+ nu: resolved-rate motion control (Whitney 1969; the baseline of MMC, arXiv 2002.11901).
  void apply(const Matrix6X& J, const Vector6& nu, VectorX& out) const noexcept;

 private:
  Matrix6 inverse_ = Matrix6::Zero();  // (J J^T + lambda^2 I)^-1
};

/// qdot += (I - J^+ J) gradient; `gradient` has one value per velocity and is overwritten.
void add_projected(const DampedInverse& inverse, const Matrix6X& J, VectorX& gradient, VectorX& scratch,
                   VectorX& qdot) noexcept;

/// Park: the gradient lambda_m J_m / lambda_q on the joints, zero on the base (baseline of MMC).
void park_gradient(const ControllerParams& params, int base_dof, const VectorX& J_m, VectorX& gradient) noexcept;

/// Baur: adds a repulsion from joint limits, ((rho - 0.9)/(0.05 - 0.9))^2 [rad/s, m/s] away from a limit nearer
/// than 0.9; 1 at the stop distance 0.05 (baseline of MMC).
void add_limit_repulsion(const RobotModel& model, const VectorX& q, VectorX& gradient) noexcept;

/// Scales qdot as a whole so that every velocity and wheel keeps its limit.
void scale_into_limits(const RobotModel& model, const VectorX& speed, VectorX& qdot) noexcept;

}  // namespace moma
