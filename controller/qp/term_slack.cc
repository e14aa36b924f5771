#include "controller/qp/terms.h"

namespace moma {

void add_slack_term(const SlackParams& params, int num_velocities, const Task& task, QpProblem& problem) noexcept {
  if (!params.enabled) return;
  problem.H.segment(num_velocities, 6) += weight_value(params.weight, task) * task.slack_scale;
}

}  // namespace moma
