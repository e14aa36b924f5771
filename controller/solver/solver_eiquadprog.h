#pragma once

#include <memory>

#include "controller/solver/solver.h"

namespace moma {

/// Eiquadprog-fast, the Goldfarb-Idnani dual method (Math. Prog. 27, 1983). It needs H > 0: zero weights are invalid
/// input. It does not distinguish infeasible from unbounded problems; with H > 0 both mean infeasible.
class EiquadprogSolver : public QpSolver {
 public:
  EiquadprogSolver();
  ~EiquadprogSolver() override;
  void allocate(int num_variables, int max_rows) override;
  bool real_time_safe() const noexcept override { return true; }

 protected:
  StepStatus do_solve(const QpProblem& problem, const Box& box, QpSolution& solution) noexcept override;
  int num_variables() const noexcept override;
  int max_rows() const noexcept override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace moma
