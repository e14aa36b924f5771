#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "controller/solver/solver.h"

namespace moma::test {

/// A QP solver: DAQP, or an oracle for it.
struct NamedSolver {
  std::string name;
  SolverMaker make;
};

/// DAQP first, then qpOASES and eiquadprog where they are installed.
std::vector<NamedSolver> solvers();

inline void PrintTo(const NamedSolver& solver, std::ostream* out) { *out << solver.name; }

}  // namespace moma::test
