#pragma once

#include "controller/describe/enumeration.h"
#include "controller/types.h"

namespace moma {

enum class ManipulabilityRows { kTranslation, kRotation, kAll };
constexpr auto words(Of<ManipulabilityRows>) {
  return std::to_array<std::string_view>({"translation", "rotation", "all"});
}

struct Manipulability {
  double value = 0.0;     ///< m >= 0
  bool singular = false;  ///< m below 1e-9: the gradient is zero then
};

/// Yoshikawa manipulability m = sqrt(det(J J^T)) of the chosen rows of the arm's Jacobian, without base columns.
/// Computed as |r_11 ... r_kk| of the QR decomposition of J^T, which keeps digits that det(J J^T) loses. @param J_arm_W
/// 6 x n, [angular; linear] in world axes, one column per controlled joint. @return >= 0; 0 if n is less than the
/// number of rows (or more than kMaxJoints, which no robot has). Real-time safe. Source: Yoshikawa, IJRR 4(2), 1985.
double manipulability(const Eigen::Ref<const Matrix6X>& J_arm_W, ManipulabilityRows rows) noexcept;

/// Derivative of column i of J_arm_W with respect to joint j, entry (., i, j) of the kinematic Hessian: with a the
/// angular and v the linear parts of the columns, [a_j x a_i; a_j x v_i] for j <= i, [0; a_i x v_j] for j > i, and zero
/// for a prismatic joint j <= i (Haviland & Corke, arXiv 2010.08686, from the derivative of a product of exponentials).
Vector6 jacobian_derivative(const Eigen::Ref<const Matrix6X>& J_arm_W,
                            const Eigen::Ref<const Eigen::VectorXi>& prismatic, Eigen::Index i,
                            Eigen::Index j) noexcept;

/// Value and gradient: gradient_i = m * vec(J H_i^T) . vec((J J^T)^-1), H_i the derivative of the rows with respect to
/// joint i (Haviland & Corke, arXiv 2002.11901, eq. 9-11; H from the columns of J alone). @param prismatic n flags, 1
/// for a prismatic joint, which turns no column of J. @param gradient n values, written; zero at a singularity. Checked
/// against central differences.
Manipulability manipulability_gradient(const Eigen::Ref<const Matrix6X>& J_arm_W,
                                       const Eigen::Ref<const Eigen::VectorXi>& prismatic, ManipulabilityRows rows,
                                       Eigen::Ref<VectorX> gradient) noexcept;

}  // namespace moma
