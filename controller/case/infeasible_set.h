#pragma once

#include <vector>

#include "controller/qp/problem.h"

namespace moma {

/// One constraint of a problem: a row, or one side of a variable's bound.
struct ConstraintId {
  enum class Kind { kRow, kLowerBound, kUpperBound };
  Kind kind = Kind::kRow;
  int index = 0;
};

/// Returns a minimal set of constraints that cannot be met together, by deletion filtering (Chinneck, Feasibility and
/// Infeasibility in Optimization, 2008, sec. 6.1): the smaller of two sets, found in two orders, which drop tracking
/// rows and the slack's bounds first. Empty if the problem is feasible or the solver cannot tell. Solves two small QPs
/// per constraint. @param num_velocities number of variables before delta
std::vector<ConstraintId> minimal_infeasible_set(const QpProblem& problem, int num_velocities);

}  // namespace moma
