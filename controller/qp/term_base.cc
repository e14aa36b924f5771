#include "controller/qp/terms.h"

namespace moma {

double weight_value(const Weight& weight, const Task& task) noexcept {
  return weight.inverse_error ? 1.0 / task.error_norm : weight.value;
}

void add_base_term(const ControllerParams& params, int base_dof, const Task& task, QpProblem& problem) noexcept {
  const auto joints = params.lambda_q.size();
  problem.H.segment(base_dof, joints) += params.lambda_q;
  if (base_dof == 0) return;
  problem.H.head(base_dof).array() += weight_value(params.base_weight, task);
  problem.g[base_dof - 1] -= params.k_epsilon * task.theta_eps;
}

}  // namespace moma
