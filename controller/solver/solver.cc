#include "controller/solver/solver.h"

#include <algorithm>
#include <cmath>

#include "controller/params.h"

namespace moma {

namespace {

// Tolerance of a solution's rows [m/s, rad/s]: rounding if the weights span 1e9.
constexpr double kRowTolerance = 1e-6;
// Bounds that cross by rounding alone count as equal.
constexpr double kCrossTolerance = 1e-12;

StepStatus check_input(const QpProblem& p, const Box& box) noexcept {
  const int n = p.n();
  if (!p.H.allFinite() || !p.g.allFinite() || !p.A.topRows(p.rows).allFinite()) return StepStatus::kInvalidInput;
  for (int i = 0; i < n; ++i)
    if (p.H[i] < 0.0) return StepStatus::kInvalidInput;
  bool crossed = false;
  const auto check = [&](double lower, double upper) {
    if (std::isnan(lower) || std::isnan(upper) || lower == kInfinity || upper == -kInfinity) return false;
    crossed = crossed || lower > upper + kCrossTolerance;
    return true;
  };
  for (int i = 0; i < n; ++i)
    if (!check(box.lower[i], box.upper[i])) return StepStatus::kInvalidInput;
  for (int i = 0; i < p.rows; ++i)
    if (!check(p.lbA[i], p.ubA[i])) return StepStatus::kInvalidInput;
  return crossed ? StepStatus::kInfeasible : StepStatus::kSolved;
}

// Accepts a solution that is finite, inside the box up to rounding (then clipped exactly) and near enough to every row.
bool accept_output(const QpProblem& p, const Box& box, VectorX& x) noexcept {
  const int n = p.n();
  for (int i = 0; i < n; ++i) {
    if (!std::isfinite(x[i])) return false;
    const double clipped = std::min(std::max(x[i], box.lower[i]), box.upper[i]);
    if (std::abs(clipped - x[i]) > kRowTolerance) return false;
    x[i] = clipped;
  }
  for (int r = 0; r < p.rows; ++r) {
    double value = 0.0;
    double scale = 1.0;
    for (int i = 0; i < n; ++i) {
      const double part = p.A(r, i) * x[i];
      value += part;
      scale += std::abs(part);
    }
    const double tolerance = kRowTolerance * scale;
    if (!(value >= p.lbA[r] - tolerance && value <= p.ubA[r] + tolerance)) return false;
  }
  return true;
}

}  // namespace

void QpSolution::allocate(int num_variables, int max_rows) {
  *this = {};  // as QpProblem::allocate()
  x = VectorX::Zero(num_variables);
  bound_multipliers = VectorX::Zero(num_variables);
  row_multipliers = VectorX::Zero(max_rows);
  iterations = 0;
}

void QpSolver::allocate(int num_variables, int max_rows) {
  num_variables_ = max_rows_ = 0;
  do_allocate(num_variables, max_rows);
  num_variables_ = num_variables;
  max_rows_ = max_rows;
}

StepStatus QpSolver::solve(const QpProblem& problem, QpSolution& solution) noexcept {
  return solve(problem, Box{problem.lb.data(), problem.ub.data()}, solution);
}

StepStatus QpSolver::solve(const QpProblem& problem, const Box& box, QpSolution& solution) noexcept {
  solution.iterations = 0;
  if (problem.n() != num_variables() || problem.rows > max_rows() || solution.x.size() < problem.n() ||
      solution.row_multipliers.size() < problem.rows)
    return StepStatus::kInvalidInput;
  const StepStatus input = check_input(problem, box);
  if (input != StepStatus::kSolved) return input;
  const StepStatus status = do_solve(problem, box, solution);
  if (status != StepStatus::kSolved) return status;
  return accept_output(problem, box, solution.x) ? StepStatus::kSolved : StepStatus::kMaxIterations;
}

}  // namespace moma
