#pragma once

#include <string>
#include <vector>

#include "controller/case/case_step.h"

namespace moma {

/// One term of the objective at the solution: its part of 1/2 x^T Q x + c^T x.
struct CostTerm {
  std::string name;
  double value = 0.0;
};

/// The terms that are switched on, in the order of controller.md, summing to ControllerCore::cost(). Computed from
/// the parameters, not from the matrices. Only for the QP method.
std::vector<CostTerm> cost_terms(const CaseStep& step);

}  // namespace moma
