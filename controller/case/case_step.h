#pragma once

#include "controller/case/case_file.h"
#include "controller/case/kkt.h"
#include "controller/controller_core.h"

namespace moma {

/// A case's controller right after its one step, and what that step returned.
struct CaseStep {
  explicit CaseStep(const ControlCase& control_case);

  const ControlCase& given;
  ControllerCore controller;
  StepResult result;
};

/// The solution of the stage that gave the command, checked by its optimality conditions.
struct StageCheck {
  QpProblem problem;  ///< of that stage: its own bounds; one more variable where relaxed
  VectorX x;
  KktReport report;
};

/// Not for closed-form methods, nor where the command brakes: there is no solution to check then.
StageCheck check_stage(const CaseStep& step);

/// False where check_stage() has nothing to check.
bool has_solution(const CaseStep& step);

}  // namespace moma
