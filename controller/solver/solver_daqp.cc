extern "C" {
#include <api.h>
#include <utils.h>
}

#include <algorithm>
#include <memory>
#include <vector>

#include "controller/solver/solver.h"

namespace moma {

namespace {

/// DAQP (Arnstrom, Bemporad, Axehill, IEEE TAC 67(8), 2022), a dual active-set method: the fastest on this problem,
/// finds every infeasibility and takes no memory once allocated.
class DaqpSolver : public QpSolver {
 protected:
  void do_allocate(int num_variables, int max_rows) override {
    state_ = std::make_unique<State>();
    State& s = *state_;
    const auto n = static_cast<std::size_t>(num_variables);
    const auto rows = static_cast<std::size_t>(max_rows);
    const std::size_t m = n + rows;
    s.H.assign(n * n, 0.0);
    s.f.assign(n, 0.0);
    s.lower.assign(m, 0.0);
    s.upper.assign(m, 0.0);
    s.x.assign(n, 0.0);
    s.multipliers.assign(m, 0.0);

    daqp_default_settings(&s.settings);
    s.settings.primal_tol = 1e-9;
    s.settings.eq_reduction = DAQP_EQ_REDUCTION_OFF;
    s.settings.iter_limit = 1000;
    DAQPWorkspace& work = s.work;
    work.settings = &s.settings;
    work.n = num_variables;
    work.m = static_cast<int>(m);
    work.ms = num_variables;
    work.outer_iter = 1;
    // The arrays of allocate_daqp_workspace() and allocate_daqp_ldp().
    for (double** one : {&work.lam, &work.lam_star, &work.D, &work.xldl, &work.zldl}) *one = s.array(n + 1);
    work.L = s.array((n + 1) * (n + 2) / 2);
    work.u = work.x = s.array(n);
    work.xold = s.array(n);
    work.WS = s.int_array(n + 1);
    work.prox_mask = s.int_array(n);
    for (double** one : {&work.scaling, &work.dupper, &work.dlower}) *one = s.array(m);
    std::fill(work.scaling, work.scaling + n, 1.0);
    work.M = s.array(n * rows);
    if (rows > 0) work.Mu = s.array(rows);
    work.sense = s.int_array(m);
    work.Rinv = s.array(n * (n + 1) / 2);
    work.v = s.array(n);
    s.qp.n = num_variables;
    s.qp.ms = num_variables;
  }
  StepStatus do_solve(const QpProblem& p, const Box& box, QpSolution& solution) noexcept override {
    State& s = *state_;
    const auto n = static_cast<std::size_t>(num_variables());
    const auto rows = static_cast<std::size_t>(p.rows);
    const auto bounded = [](double v) { return std::min(std::max(v, -DAQP_INF), DAQP_INF); };
    for (std::size_t i = 0; i < n; ++i) {
      s.H[i * n + i] = p.H[static_cast<Eigen::Index>(i)];
      s.f[i] = p.g[static_cast<Eigen::Index>(i)];
      s.lower[i] = bounded(box.lower[i]);
      s.upper[i] = bounded(box.upper[i]);
    }
    for (std::size_t i = 0; i < rows; ++i) {
      s.lower[n + i] = bounded(p.lbA[static_cast<Eigen::Index>(i)]);
      s.upper[n + i] = bounded(p.ubA[static_cast<Eigen::Index>(i)]);
    }
    s.qp.m = static_cast<int>(n + rows);
    s.qp.H = s.H.data();
    s.qp.f = s.f.data();
    s.qp.A = const_cast<double*>(p.A.data());  // DAQP's interface is not const-correct; it only reads A
    s.qp.blower = s.lower.data();
    s.qp.bupper = s.upper.data();
    s.qp.sense = nullptr;

    // Cold start: no earlier solve may influence this one's bits.
    reset_daqp_workspace(&s.work);
    s.work.state = 0;
    std::fill(s.work.x, s.work.x + n, 0.0);
    std::fill(s.work.xold, s.work.xold + n, 0.0);
    s.work.m = s.qp.m;
    const int mask = DAQP_UPDATE_Rinv | DAQP_UPDATE_M | DAQP_UPDATE_v | DAQP_UPDATE_d | DAQP_UPDATE_sense;
    int flag = daqp_update_ldp(mask, &s.work, &s.qp);
    DAQPResult result{};
    result.x = s.x.data();
    result.lam = s.multipliers.data();
    if (flag >= 0) {
      daqp_solve(&result, &s.work);
      flag = result.exitflag;
      solution.iterations = result.iter;
    }
    // Contradictory equality rows appear while the first working set is built.
    if (flag == DAQP_EXIT_INFEASIBLE || flag == DAQP_EXIT_OVERDETERMINED_INITIAL) return StepStatus::kInfeasible;
    if (flag != DAQP_EXIT_OPTIMAL) return StepStatus::kMaxIterations;
    for (std::size_t i = 0; i < n; ++i) {
      solution.x[static_cast<Eigen::Index>(i)] = s.x[i];
      solution.bound_multipliers[static_cast<Eigen::Index>(i)] = s.multipliers[i];
    }
    for (std::size_t i = 0; i < rows; ++i)
      solution.row_multipliers[static_cast<Eigen::Index>(i)] = s.multipliers[n + i];
    return StepStatus::kSolved;
  }

 private:
  struct State {
    // The arrays of the workspace are ours, not those of DAQP's allocate_ and setup_ functions, which write through
    // what malloc() gives them without looking. A block each, so that memory checkers see where one ends.
    DAQPWorkspace work{};
    DAQPSettings settings{};
    std::vector<std::vector<double>> numbers;
    std::vector<std::vector<int>> words;
    DAQPProblem qp{};
    // DAQP reads a dense row-major H and bounds of variables and rows in one array.
    std::vector<double> H, f, lower, upper, x, multipliers;

    double* array(std::size_t count) { return numbers.emplace_back(std::max<std::size_t>(count, 1), 0.0).data(); }
    int* int_array(std::size_t count) { return words.emplace_back(std::max<std::size_t>(count, 1), 0).data(); }
  };
  std::unique_ptr<State> state_;
};

}  // namespace

std::unique_ptr<QpSolver> make_solver() { return std::make_unique<DaqpSolver>(); }

}  // namespace moma
