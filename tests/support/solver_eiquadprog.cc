#include <algorithm>
#include <cmath>
#include <eiquadprog/eiquadprog-fast.hpp>
#include <memory>
#include <vector>

#include "tests/support/solvers.h"

namespace moma::test {
namespace {

// Rows whose limits are this close are equalities.
constexpr double kEqual = 1e-12;

// Origin of a one-sided inequality: a variable (index < n) or a row, and which of its limits.
struct Side {
  int index = -1;
  double sign = 0.0;  // +1 at the upper limit, -1 at the lower
};

/// eiquadprog-fast, the Goldfarb-Idnani dual method (Math. Prog. 27, 1983). It needs H > 0: weights of zero are refused
/// as invalid input. It cannot tell an infeasible from an unbounded problem; with H > 0 both mean infeasible.
class EiquadprogSolver : public QpSolver {
 protected:
  void do_allocate(int num_variables, int max_rows) override {
    state_ = std::make_unique<State>();  // as QpProblem::allocate()
    State& s = *state_;
    const int n = num_variables;
    const int sides = 2 * (n + max_rows);
    s.H = MatrixX::Zero(n, n);
    s.CI = MatrixX::Zero(sides, n);
    s.ci0 = VectorX::Zero(sides);
    s.x = VectorX::Zero(n);
    s.sides.assign(static_cast<std::size_t>(sides), Side{});
    s.equal_rows.assign(static_cast<std::size_t>(max_rows), 0);
    s.num_equal = -1;
    s.size(std::min(6, max_rows));
    s.solver.setMaxIter(1000);
  }
  StepStatus do_solve(const QpProblem& p, const Box& box, QpSolution& solution) noexcept override {
    State& s = *state_;
    const int n = num_variables();
    for (int i = 0; i < n; ++i) {
      if (p.H[i] <= 0.0) return StepStatus::kInvalidInput;
      s.H(i, i) = p.H[i];
    }
    int equal = 0;
    for (int r = 0; r < p.rows; ++r)
      if (p.ubA[r] - p.lbA[r] < kEqual) s.equal_rows[static_cast<std::size_t>(equal++)] = r;
    s.size(equal);
    for (int k = 0; k < equal; ++k) {
      const int r = s.equal_rows[static_cast<std::size_t>(k)];
      s.CE.row(k) = p.A.row(r);
      s.ce0[k] = -p.ubA[r];
    }
    s.CI.setZero();
    s.ci0.setOnes();
    int used = 0;
    const auto side = [&](int index, double sign, double limit) {
      if (std::isinf(limit)) return;
      if (index < n)
        s.CI(used, index) = -sign;
      else
        s.CI.row(used) = -sign * p.A.row(index - n);
      s.ci0[used] = sign * limit;
      s.sides[static_cast<std::size_t>(used++)] = {index, sign};
    };
    for (int i = 0; i < n; ++i) {
      side(i, 1.0, box.upper[i]);
      side(i, -1.0, box.lower[i]);
    }
    for (int r = 0; r < p.rows; ++r) {
      if (p.ubA[r] - p.lbA[r] < kEqual) continue;
      side(n + r, 1.0, p.ubA[r]);
      side(n + r, -1.0, p.lbA[r]);
    }
    using eiquadprog::solvers::EiquadprogFast_status;
    const auto status = s.solver.solve_quadprog(s.H, p.g, s.CE, s.ce0, s.CI, s.ci0, s.x);
    solution.iterations = s.solver.getIteratios();
    switch (status) {
      case EiquadprogFast_status::EIQUADPROG_FAST_OPTIMAL:
        break;
      case EiquadprogFast_status::EIQUADPROG_FAST_INFEASIBLE:
      case EiquadprogFast_status::EIQUADPROG_FAST_UNBOUNDED:
        return StepStatus::kInfeasible;
      // Dependent equalities may be consistent: better no answer than a wrong one.
      case EiquadprogFast_status::EIQUADPROG_FAST_REDUNDANT_EQUALITIES:
      case EiquadprogFast_status::EIQUADPROG_FAST_MAX_ITER_REACHED:
        return StepStatus::kMaxIterations;
    }
    solution.x.head(n) = s.x;
    solution.bound_multipliers.setZero();
    solution.row_multipliers.setZero();
    const VectorX& u = s.solver.getLagrangeMultipliers();
    const Eigen::VectorXi& active = s.solver.getActiveSet();
    for (int k = 0; k < static_cast<int>(s.solver.getActiveSetSize()); ++k) {
      if (active[k] < 0) {
        // Equalities are numbered -1, -2, ...; their multiplier is that of CE x + ce0 = 0 on the other side.
        solution.row_multipliers[s.equal_rows[static_cast<std::size_t>(-active[k] - 1)]] = -u[k];
        continue;
      }
      const Side& from = s.sides[static_cast<std::size_t>(active[k])];
      if (from.index < n)
        solution.bound_multipliers[from.index] += from.sign * u[k];
      else
        solution.row_multipliers[from.index - n] += from.sign * u[k];
    }
    return StepStatus::kSolved;
  }

 private:
  struct State {
    int num_equal = -1;
    eiquadprog::solvers::EiquadprogFast solver;
    MatrixX H, CE, CI;
    VectorX ce0, ci0, x;
    std::vector<Side> sides;
    std::vector<int> equal_rows;

    // The solver's own sizes: spare inequalities are 0 x + 1 >= 0, spare equalities do not exist (a zero row is
    // dependent), so that a step with another number of equalities resizes here.
    void size(int equal) {
      if (equal == num_equal) return;
      num_equal = equal;
      CE = MatrixX::Zero(equal, CI.cols());
      ce0 = VectorX::Zero(equal);
      solver.reset(static_cast<std::size_t>(CI.cols()), static_cast<std::size_t>(equal),
                   static_cast<std::size_t>(CI.rows()));
    }
  };
  std::unique_ptr<State> state_;
};

}  // namespace

std::unique_ptr<QpSolver> make_eiquadprog() { return std::make_unique<EiquadprogSolver>(); }

}  // namespace moma::test
