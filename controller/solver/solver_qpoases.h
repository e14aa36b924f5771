#pragma once

#include <memory>

#include "controller/solver/solver.h"

namespace moma {

/// qpOASES (Ferreau et al., Math. Prog. Comp. 6(4), 2014) with its "Reliable" options and a cold start: the reference
/// for cross-checks. It allocates and takes a process-wide lock in every solve, and is not meant for a control loop.
class QpoasesSolver : public QpSolver {
 public:
  QpoasesSolver();
  ~QpoasesSolver() override;
  void allocate(int num_variables, int max_rows) override;
  bool real_time_safe() const noexcept override { return false; }

 protected:
  StepStatus do_solve(const QpProblem& problem, const Box& box, QpSolution& solution) noexcept override;
  int num_variables() const noexcept override;
  int max_rows() const noexcept override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace moma
