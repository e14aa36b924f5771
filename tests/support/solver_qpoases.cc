#include <algorithm>
#include <memory>
#include <mutex>
#include <qpOASES.hpp>
#include <vector>

#include "tests/support/solvers.h"

namespace moma::test {
namespace {

/// qpOASES (Ferreau et al., Math. Prog. Comp. 6(4), 2014) with its "Reliable" options, started cold: the reference for
/// cross-checks. It takes memory and a process-wide lock in every solve.
class QpoasesSolver : public QpSolver {
 protected:
  void do_allocate(int num_variables, int max_rows) override {
    const auto n = static_cast<std::size_t>(num_variables);
    const std::size_t m = n + static_cast<std::size_t>(max_rows);
    H_.assign(n * n, 0.0);
    lower_.assign(m, 0.0);
    upper_.assign(m, 0.0);
    dual_.assign(m, 0.0);
  }
  StepStatus do_solve(const QpProblem& p, const Box& box, QpSolution& solution) noexcept override {
    const auto n = static_cast<std::size_t>(num_variables());
    const auto rows = static_cast<std::size_t>(p.rows);
    const auto bounded = [](double v) { return std::min(std::max(v, -qpOASES::INFTY), qpOASES::INFTY); };
    for (std::size_t i = 0; i < n; ++i) {
      H_[i * n + i] = p.H[static_cast<Eigen::Index>(i)];
      lower_[i] = bounded(box.lower[i]);
      upper_[i] = bounded(box.upper[i]);
    }
    for (std::size_t i = 0; i < rows; ++i) {
      lower_[n + i] = bounded(p.lbA[static_cast<Eigen::Index>(i)]);
      upper_[n + i] = bounded(p.ubA[static_cast<Eigen::Index>(i)]);
    }
    // QpOASES has one message handler per process and writes to it in every solve.
    static std::mutex handler_in_use;
    const std::lock_guard<std::mutex> lock(handler_in_use);
    qpOASES::Options options;
    options.setToReliable();
    options.enableDriftCorrection = 1;
    options.printLevel = qpOASES::PL_NONE;
    qpOASES::QProblem problem(num_variables(), p.rows, qpOASES::HST_UNKNOWN);
    problem.setOptions(options);
    qpOASES::int_t iterations = 1000;
    const qpOASES::returnValue flag = problem.init(H_.data(), p.g.data(), p.A.data(), lower_.data(), upper_.data(),
                                                   lower_.data() + n, upper_.data() + n, iterations);
    solution.iterations = static_cast<int>(iterations);
    if (problem.isInfeasible() == qpOASES::BT_TRUE) return StepStatus::kInfeasible;
    if (flag != qpOASES::SUCCESSFUL_RETURN) return StepStatus::kMaxIterations;
    problem.getPrimalSolution(solution.x.data());
    problem.getDualSolution(dual_.data());
    // qpOASES counts multipliers positive at lower limits.
    for (std::size_t i = 0; i < n; ++i) solution.bound_multipliers[static_cast<Eigen::Index>(i)] = -dual_[i];
    for (std::size_t i = 0; i < rows; ++i) solution.row_multipliers[static_cast<Eigen::Index>(i)] = -dual_[n + i];
    return StepStatus::kSolved;
  }

 private:
  std::vector<double> H_, lower_, upper_, dual_;
};

}  // namespace

std::unique_ptr<QpSolver> make_qpoases() { return std::make_unique<QpoasesSolver>(); }

}  // namespace moma::test
