#pragma once

#include <memory>

#include "controller/solver/solver.h"

namespace moma {

/// DAQP (Arnstrom, Bemporad, Axehill, IEEE TAC 67(8), 2022), a dual active-set method. The default: fastest on this
/// problem, it detects every infeasibility and does not allocate in solve().
class DaqpSolver : public QpSolver {
 public:
  DaqpSolver();
  ~DaqpSolver() override;
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
