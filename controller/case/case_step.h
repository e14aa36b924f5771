#pragma once

#include "controller/case/case_file.h"
#include "controller/controller_core.h"

namespace moma {

/// A case's controller right after its one step, and the result of that step.
struct CaseStep {
  explicit CaseStep(const ControlCase& control_case, SolverMaker make_qp_solver = &make_solver)
      : given(control_case),
        controller(control_case.robot.model, control_case.controller, control_case.control_period, make_qp_solver) {
    controller.reset(control_case.objects);
    ControllerMemory memory;
    controller.get_memory(memory);
    memory.escape = control_case.memory.escape;
    if (!control_case.memory.prediction.computed.empty()) memory.prediction = control_case.memory.prediction;
    if (control_case.has_plan) memory.plan = control_case.memory.plan;
    memory.map = control_case.memory.map;
    controller.set_memory(memory);
    controller.prepare(result);
    controller.step(control_case.observation, result);
  }

  /// False for closed-form methods, and where the command brakes: there is no solution to show or to check.
  bool has_solution() const { return controller.params().method == Method::kQp && result.fallback != Fallback::kBrake; }

  const ControlCase& given;
  ControllerCore controller;
  StepResult result;
};

}  // namespace moma
