#pragma once

#include "controller/case/case_file.h"
#include "controller/controller_core.h"

namespace moma {

/// A case's controller right after its one step, and the result of that step.
struct CaseStep {
  explicit CaseStep(const ControlCase& control_case, SolverMaker make_qp_solver = &make_solver);

  /// False for closed-form methods, and where the command brakes: there is no solution to show or to check.
  bool has_solution() const { return controller.params().method == Method::kQp && result.fallback != Fallback::kBrake; }

  const ControlCase& given;
  ControllerCore controller;
  StepResult result;
};

}  // namespace moma
