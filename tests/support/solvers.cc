#include "tests/support/solvers.h"

namespace moma::test {

// Each in its own file, solver_NAME.cc.
std::unique_ptr<QpSolver> make_qpoases();
std::unique_ptr<QpSolver> make_eiquadprog();

std::vector<NamedSolver> solvers() {
  return {
      {"daqp", &make_solver},
#ifdef MOMA_HAVE_QPOASES
      {"qpoases", &make_qpoases},
#endif
#ifdef MOMA_HAVE_EIQUADPROG
      {"eiquadprog", &make_eiquadprog},
#endif
  };
}

}  // namespace moma::test
