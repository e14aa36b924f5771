#include "controller/qp/terms.h"

namespace moma {

void add_acceleration_term(const VectorX& weight, const VectorX& qdot_measured, QpProblem& problem) noexcept {
  const auto nv = weight.size();
  problem.H.head(nv) += weight;
  problem.g.head(nv) -= weight.cwiseProduct(qdot_measured);
}

}  // namespace moma
