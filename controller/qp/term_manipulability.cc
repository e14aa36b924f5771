#include "controller/qp/terms.h"

namespace moma {

void add_manipulability_term(const ManipulabilityParams& params, int base_dof, const VectorX& gradient,
                             QpProblem& problem) noexcept {
  if (params.weight == 0.0) return;
  problem.g.segment(base_dof, gradient.size()) -= params.weight * gradient;
}

}  // namespace moma
