#pragma once

#include <string>
#include <vector>

#include "controller/qp/problem.h"

namespace moma {

/// One constraint of a problem: a row, or one side of a variable's bound.
struct ConstraintId {
  enum class Kind { kRow, kLowerBound, kUpperBound };
  Kind kind = Kind::kRow;
  int index = 0;
};

/// A set of constraints that cannot be met together, minimal: without any one of them the others can. Found by
/// deletion filtering (Chinneck, Feasibility and Infeasibility in Optimization, 2008, sec. 6.1), dropping tracking
/// rows and the slack's bounds first, so that what remains speaks of the robot and its surroundings where it can; the
/// smaller of two such sets, found in two orders. There may be others. Empty where the problem is feasible, or where
/// the solver could not tell. Solves two small QPs per constraint.
/// @param num_velocities how many of the variables come before delta
std::vector<ConstraintId> minimal_infeasible_set(const QpProblem& problem, int num_velocities);

}  // namespace moma
