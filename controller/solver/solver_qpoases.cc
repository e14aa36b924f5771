#include "controller/solver/solver_qpoases.h"

#include <algorithm>
#include <mutex>
#include <qpOASES.hpp>
#include <vector>

namespace moma {

struct QpoasesSolver::Impl {
  int n = 0;
  int max_rows = 0;
  std::vector<double> H, lower, upper, dual;
};

QpoasesSolver::QpoasesSolver() : impl_(std::make_unique<Impl>()) {}
QpoasesSolver::~QpoasesSolver() = default;
int QpoasesSolver::num_variables() const noexcept { return impl_->n; }
int QpoasesSolver::max_rows() const noexcept { return impl_->max_rows; }

void QpoasesSolver::allocate(int num_variables, int max_rows) {
  Impl& s = *impl_;
  s.n = num_variables;
  s.max_rows = max_rows;
  const auto n = static_cast<std::size_t>(num_variables);
  const std::size_t m = n + static_cast<std::size_t>(max_rows);
  s.H.assign(n * n, 0.0);
  s.lower.assign(m, 0.0);
  s.upper.assign(m, 0.0);
  s.dual.assign(m, 0.0);
}

StepStatus QpoasesSolver::do_solve(const QpProblem& p, const Box& box, QpSolution& solution) noexcept {
  Impl& s = *impl_;
  const auto n = static_cast<std::size_t>(s.n);
  const auto rows = static_cast<std::size_t>(p.rows);
  const auto bounded = [](double v) { return std::min(std::max(v, -qpOASES::INFTY), qpOASES::INFTY); };
  for (std::size_t i = 0; i < n; ++i) {
    s.H[i * n + i] = p.H[static_cast<Eigen::Index>(i)];
    s.lower[i] = bounded(box.lower[i]);
    s.upper[i] = bounded(box.upper[i]);
  }
  for (std::size_t i = 0; i < rows; ++i) {
    s.lower[n + i] = bounded(p.lbA[static_cast<Eigen::Index>(i)]);
    s.upper[n + i] = bounded(p.ubA[static_cast<Eigen::Index>(i)]);
  }
  // qpOASES has one message handler per process and writes to it in every solve.
  static std::mutex handler_in_use;
  const std::lock_guard<std::mutex> lock(handler_in_use);
  qpOASES::Options options;
  options.setToReliable();
  options.enableDriftCorrection = 1;
  options.printLevel = qpOASES::PL_NONE;
  qpOASES::QProblem problem(s.n, p.rows, qpOASES::HST_UNKNOWN);
  problem.setOptions(options);
  qpOASES::int_t iterations = 1000;
  const qpOASES::returnValue flag = problem.init(s.H.data(), p.g.data(), p.A.data(), s.lower.data(), s.upper.data(),
                                                 s.lower.data() + n, s.upper.data() + n, iterations);
  solution.iterations = static_cast<int>(iterations);
  if (problem.isInfeasible() == qpOASES::BT_TRUE) return StepStatus::kInfeasible;
  if (flag != qpOASES::SUCCESSFUL_RETURN) return StepStatus::kMaxIterations;
  problem.getPrimalSolution(solution.x.data());
  problem.getDualSolution(s.dual.data());
  // qpOASES's multipliers are positive at lower limits.
  for (std::size_t i = 0; i < n; ++i) solution.bound_multipliers[static_cast<Eigen::Index>(i)] = -s.dual[i];
  for (std::size_t i = 0; i < rows; ++i) solution.row_multipliers[static_cast<Eigen::Index>(i)] = -s.dual[n + i];
  return StepStatus::kSolved;
}

}  // namespace moma
