#include "controller/case/case_step.h"

namespace moma {

CaseStep::CaseStep(const ControlCase& control_case, SolverMaker make_qp_solver)
    : given(control_case),
      controller(control_case.robot.model, control_case.controller, control_case.control_period, make_qp_solver) {
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

}  // namespace moma
