#pragma once

#include <memory>

#include "controller/qp/problem.h"
#include "controller/step.h"

namespace moma {

/// Multipliers are positive at upper and negative at lower limits: H x + g + A^T rows + bounds = 0.
struct QpSolution {
  VectorX x;                  ///< n (of the largest stage); finite and inside the bounds if solved
  VectorX bound_multipliers;  ///< n
  VectorX row_multipliers;    ///< capacity of the problem
  int iterations = 0;

  void allocate(int num_variables, int max_rows);
};

/// Box bounds that replace the problem's own (a stage of the fallback).
struct Box {
  const double* lower = nullptr;
  const double* upper = nullptr;
};

/// Common interface of QP solvers. No warm start: a step's bits depend on its inputs alone, so that `moma solve` and a
/// replay repeat them. Checks inputs and outputs, which most solvers do not.
class QpSolver {
 public:
  virtual ~QpSolver() = default;
  QpSolver() = default;
  QpSolver(const QpSolver&) = delete;
  QpSolver& operator=(const QpSolver&) = delete;

  /// Sizes the workspace for problems of exactly `num_variables` and at most `max_rows` rows.
  void allocate(int num_variables, int max_rows);

  /// Returns kSolved, with solution.x inside the box and within 1e-6 of every row; kInfeasible; kMaxIterations (also if
  /// the solver gave up or returned a wrong point); kInvalidInput (a NaN, an infinite coefficient, a wrong size).
  /// Writes `solution` only if solved, and its `iterations` always.
  StepStatus solve(const QpProblem& problem, QpSolution& solution) noexcept;
  StepStatus solve(const QpProblem& problem, const Box& box, QpSolution& solution) noexcept;

 protected:
  virtual void do_allocate(int num_variables, int max_rows) = 0;
  virtual StepStatus do_solve(const QpProblem& problem, const Box& box, QpSolution& solution) noexcept = 0;
  int num_variables() const noexcept { return num_variables_; }
  int max_rows() const noexcept { return max_rows_; }

 private:
  int num_variables_ = 0;
  int max_rows_ = 0;
};

using SolverMaker = std::unique_ptr<QpSolver> (*)();

/// Makes a solver of this library: DAQP, whose solve() neither allocates nor locks.
std::unique_ptr<QpSolver> make_solver();

}  // namespace moma
