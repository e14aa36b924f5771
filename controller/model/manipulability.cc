#include "controller/model/manipulability.h"

#include "controller/model/robot_model.h"

namespace moma {
namespace {

constexpr double kSingular = 1e-9;

// Thin QR of J^T (n x R) by modified Gram-Schmidt, each column orthogonalised twice; on the stack.
template <int R>
struct ThinQr {
  Eigen::Matrix<double, Eigen::Dynamic, R, Eigen::ColMajor, kMaxJoints, R> Q;
  Eigen::Matrix<double, R, R> U;  // upper triangular
  double volume = 1.0;            // product of U's diagonal = sqrt(det(J J^T))

  explicit ThinQr(const Eigen::Ref<const Matrix6X>& J, int first_row) noexcept {
    Q = J.middleRows<R>(first_row).transpose();
    U.setZero();
    for (int k = 0; k < R; ++k) {
      for (int pass = 0; pass < 2; ++pass) {
        for (int i = 0; i < k; ++i) {
          const double along = Q.col(i).dot(Q.col(k));
          Q.col(k) -= along * Q.col(i);
          U(i, k) += along;
        }
      }
      U(k, k) = Q.col(k).norm();
      volume *= U(k, k);
      if (U(k, k) > 0.0) Q.col(k) /= U(k, k);
    }
    if (!(volume >= 0.0)) volume = 0.0;  // NaN in, singular out
  }
};

template <int R>
double value_of(const Eigen::Ref<const Matrix6X>& J, int first_row) noexcept {
  return J.cols() < R || J.cols() > kMaxJoints ? 0.0 : ThinQr<R>(J, first_row).volume;
}

// Inlined into the innermost loop of the gradient.
inline Vector6 derivative_of(const Eigen::Ref<const Matrix6X>& J, const Eigen::Ref<const Eigen::VectorXi>& prismatic,
                             Eigen::Index i, Eigen::Index j) noexcept {
  const Vector3 angular = J.col(i).head<3>();
  Vector6 derivative = Vector6::Zero();
  if (j <= i) {  // joint j carries joint i: it turns the whole column
    if (prismatic[j] != 0) return derivative;
    const Vector3 axis = J.col(j).head<3>();
    derivative << axis.cross(angular), axis.cross(J.col(i).tail<3>());
  } else {  // joint j only moves E as seen from joint i
    derivative.tail<3>() = angular.cross(J.col(j).tail<3>());
  }
  return derivative;
}

template <int R>
Manipulability gradient_of(const Eigen::Ref<const Matrix6X>& J, const Eigen::Ref<const Eigen::VectorXi>& prismatic,
                           int first_row, Eigen::Ref<VectorX> gradient) noexcept {
  gradient.setZero();
  Manipulability result{0.0, true};
  if (J.cols() < R || J.cols() > kMaxJoints) return result;
  const ThinQr<R> qr(J, first_row);
  result.value = qr.volume;
  if (!(result.value >= kSingular)) return result;
  result.singular = false;

  // gradient_j = m tr((J J^T)^-1 H_j J^T) = m sum_i b_i . dJ_i/dq_j with b_i column i of (J J^T)^-1 J = U^-1 Q^T.
  for (Eigen::Index i = 0; i < J.cols(); ++i) {
    Eigen::Matrix<double, R, 1> b = qr.Q.row(i).transpose();
    qr.U.template triangularView<Eigen::Upper>().solveInPlace(b);
    Vector6 weight = Vector6::Zero();
    weight.segment<R>(first_row) = b;
    for (Eigen::Index j = 0; j < J.cols(); ++j) {
      if (j <= i && prismatic[j] != 0) continue;
      gradient[j] += weight.dot(derivative_of(J, prismatic, i, j));
    }
  }
  gradient *= result.value;
  return result;
}

}  // namespace

Vector6 jacobian_derivative(const Eigen::Ref<const Matrix6X>& J_arm_W,
                            const Eigen::Ref<const Eigen::VectorXi>& prismatic, Eigen::Index i,
                            Eigen::Index j) noexcept {
  return derivative_of(J_arm_W, prismatic, i, j);
}

double manipulability(const Eigen::Ref<const Matrix6X>& J_arm_W, ManipulabilityRows rows) noexcept {
  switch (rows) {
    case ManipulabilityRows::kTranslation:
      return value_of<3>(J_arm_W, 3);
    case ManipulabilityRows::kRotation:
      return value_of<3>(J_arm_W, 0);
    case ManipulabilityRows::kAll:
      return value_of<6>(J_arm_W, 0);
  }
  return 0.0;
}

Manipulability manipulability_gradient(const Eigen::Ref<const Matrix6X>& J_arm_W,
                                       const Eigen::Ref<const Eigen::VectorXi>& prismatic, ManipulabilityRows rows,
                                       Eigen::Ref<VectorX> gradient) noexcept {
  switch (rows) {
    case ManipulabilityRows::kTranslation:
      return gradient_of<3>(J_arm_W, prismatic, 3, gradient);
    case ManipulabilityRows::kRotation:
      return gradient_of<3>(J_arm_W, prismatic, 0, gradient);
    case ManipulabilityRows::kAll:
      return gradient_of<6>(J_arm_W, prismatic, 0, gradient);
  }
  return {0.0, true};
}

}  // namespace moma
