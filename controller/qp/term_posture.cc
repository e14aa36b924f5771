#include "controller/qp/terms.h"

namespace moma {

void add_posture_term(const PostureParams& params, int base_dof, const VectorX& target, const VectorX& q,
                      QpProblem& problem) noexcept {
  if (params.weight == 0.0) return;
  problem.H.segment(base_dof, q.size()).array() += params.weight;
  problem.g.segment(base_dof, q.size()) -= params.weight * params.gain * (target - q);
}

}  // namespace moma
