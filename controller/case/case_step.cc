#include "controller/case/case_step.h"

#include "controller/ahead/lookahead.h"

namespace moma {

CaseStep::CaseStep(const ControlCase& control_case)
    : given(control_case), controller(control_case.robot.model, control_case.controller, control_case.control_period) {
  controller.reset(control_case.objects);
  ControllerMemory memory;
  controller.get_memory(memory);
  memory.escape = control_case.memory.escape;
  if (!control_case.memory.prediction.computed.empty()) memory.prediction = control_case.memory.prediction;
  if (control_case.has_plan) memory.plan = control_case.memory.plan;
  controller.set_memory(memory);
  controller.prepare(result);
  controller.step(control_case.observation, result);
}

bool has_solution(const CaseStep& step) {
  return step.controller.params().method == Method::kQp && step.result.fallback != Fallback::kBrake;
}

StageCheck check_stage(const CaseStep& step) {
  StageCheck out{step.controller.final_problem(), {}, {}};
  const QpProblem& p = out.problem;
  out.x = step.controller.solution().x.head(p.n());
  const MatrixX Q = p.H.asDiagonal();
  const MatrixX A = p.A.topRows(p.rows);
  const VectorX lbA = p.lbA.head(p.rows), ubA = p.ubA.head(p.rows);
  out.report = check_kkt({Q, p.g, A, lbA, ubA, p.lb, p.ub}, out.x);
  return out;
}

}  // namespace moma
