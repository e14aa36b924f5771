#include "controller/closed_form/closed_form.h"

namespace moma {

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

}  // namespace moma
