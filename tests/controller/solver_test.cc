// The QP solvers on problems made with a known optimum, and on what is wrong in itself.

#include <gtest/gtest.h>

#include "controller/solver/fallback.h"
#include "controller/solver/solver.h"
#include "tests/controller/qp_robots.h"
#include "tests/support/solvers.h"

namespace moma {
namespace {

using namespace test;

// Draws x, multipliers and active sets first, then the g and bounds that make them optimal: the answer is known.
struct Known {
  QpProblem problem;
  VectorX x;
};

Known known(Rng& rng, int n, int rows) {
  Known k;
  QpProblem& p = k.problem;
  p.allocate(n, rows + 3);
  p.rows = rows;
  k.x = VectorX::NullaryExpr(n, [&] { return uniform(rng, -1, 1); });
  p.H = VectorX::NullaryExpr(n, [&] { return std::pow(10.0, uniform(rng, -3, 3)); });
  p.A = RowMatrix::NullaryExpr(rows + 3, n, [&] { return rng() % 4 == 0 ? 0.0 : uniform(rng, -1, 1); });
  VectorX gradient = p.H.cwiseProduct(k.x);
  int active = 0;
  const auto limits = [&](double value, double& lower, double& upper, bool allow_equal) {
    lower = rng() % 5 == 0 ? -kInfinity : value - uniform(rng, 0.1, 2);
    upper = rng() % 5 == 0 ? kInfinity : value + uniform(rng, 0.1, 2);
    const auto pick = rng() % 6;
    if (active >= n - 1 || pick > 2) return 0.0;
    ++active;
    if (pick == 0) {
      upper = value;
      return uniform(rng, 0.1, 2);
    }
    if (pick == 1 || !allow_equal) {
      lower = value;
      return -uniform(rng, 0.1, 2);
    }
    lower = upper = value;
    return uniform(rng, -2, 2);
  };
  for (int i = 0; i < n; ++i) gradient[i] += limits(k.x[i], p.lb[i], p.ub[i], false);
  for (int r = 0; r < rows; ++r) {
    const double multiplier = limits(p.A.row(r).dot(k.x), p.lbA[r], p.ubA[r], true);
    gradient += multiplier * p.A.row(r).transpose();
  }
  p.g = -gradient;
  return k;
}

class Solvers : public ::testing::TestWithParam<NamedSolver> {
 protected:
  void size(const QpProblem& p) {
    solver_->allocate(p.n(), p.capacity());
    solution_.allocate(p.n(), p.capacity());
  }
  std::unique_ptr<QpSolver> solver_ = GetParam().make();
  QpSolution solution_;
};

TEST_P(Solvers, FindsKnownOptima) {
  Rng rng(51);
  for (int trial = 0; trial < 500; ++trial) {
    const int n = 2 + static_cast<int>(rng() % 20);
    const Known k = known(rng, n, static_cast<int>(rng() % 40));
    size(k.problem);
    ASSERT_EQ(solver_->solve(k.problem, solution_), StepStatus::kSolved) << "trial " << trial;
    EXPECT_NEAR(k.problem.cost(solution_.x), k.problem.cost(k.x), 1e-6 * (1 + std::abs(k.problem.cost(k.x))));
    EXPECT_LT(kkt_residual(k.problem, solution_.x, solution_.bound_multipliers, solution_.row_multipliers), 1e-6)
        << "trial " << trial;
    EXPECT_LT((solution_.x - k.x).lpNorm<Eigen::Infinity>(), 1e-5) << "trial " << trial;
  }
}

TEST_P(Solvers, SaysInfeasible) {
  Rng rng(52);
  int found = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 2 + static_cast<int>(rng() % 20);
    Known k = known(rng, n, 4 + static_cast<int>(rng() % 20));
    QpProblem& p = k.problem;
    // A positive combination of two rows that contradicts itself: a x <= b and a x >= b + gap, seen apart.
    const int r = p.rows - 1;
    p.A.row(r) = -p.A.row(0);
    if (p.A.row(0).norm() < 1e-3) continue;
    const double value = p.A.row(0).dot(k.x);
    p.lbA[0] = p.lbA[r] = -kInfinity;
    p.ubA[0] = value;
    p.ubA[r] = -value - uniform(rng, 1e-3, 1.0);
    size(p);
    const StepStatus status = solver_->solve(p, solution_);
    // eiquadprog gives up where equalities depend on each other, before it looks at the rest.
    if (GetParam().name == "eiquadprog" && status == StepStatus::kMaxIterations) continue;
    EXPECT_EQ(status, StepStatus::kInfeasible) << "trial " << trial;
    ++found;
  }
  EXPECT_GT(found, 150);
}

TEST_P(Solvers, ReusedWorkspaceGivesTheSameBits) {
  Rng rng(53);
  std::vector<Known> problems;
  for (int i = 0; i < 60; ++i) problems.push_back(known(rng, 12, static_cast<int>(rng() % 20)));
  solver_->allocate(12, 23);
  for (Known& k : problems) {
    k.problem.A.conservativeResize(23, 12);
    solution_.allocate(12, 23);
    const StepStatus status = solver_->solve(k.problem, solution_);
    const auto fresh = GetParam().make();
    fresh->allocate(12, 23);
    QpSolution again;
    again.allocate(12, 23);
    ASSERT_EQ(fresh->solve(k.problem, again), status);
    EXPECT_EQ(again.x, solution_.x);
    EXPECT_EQ(again.row_multipliers, solution_.row_multipliers);
  }
}

TEST_P(Solvers, RefusesWhatIsNotANumber) {
  Rng rng(54);
  const Known k = known(rng, 6, 5);
  size(k.problem);
  const auto refuses = [&](const char* what, auto change) {
    QpProblem p = k.problem;
    change(p);
    EXPECT_EQ(solver_->solve(p, solution_), StepStatus::kInvalidInput) << what;
  };
  for (const double bad : {std::nan(""), kInfinity}) {
    refuses("H", [&](QpProblem& p) { p.H[2] = bad; });
    refuses("g", [&](QpProblem& p) { p.g[2] = bad; });
    refuses("A", [&](QpProblem& p) { p.A(4, 1) = bad; });
    refuses("lb", [&](QpProblem& p) { p.lb[0] = bad; });
    refuses("lbA", [&](QpProblem& p) { p.lbA[0] = bad; });
    refuses("ub", [&](QpProblem& p) { p.ub[0] = -bad; });
    refuses("ubA", [&](QpProblem& p) { p.ubA[0] = -bad; });
  }
  refuses("negative H", [](QpProblem& p) { p.H[0] = -1; });
  QpProblem other;
  other.allocate(7, 5);
  EXPECT_EQ(solver_->solve(other, solution_), StepStatus::kInvalidInput) << "another size";
  // Beyond the rows in use anything may stand.
  QpProblem rest = k.problem;
  rest.A.row(rest.rows).setConstant(NAN);
  EXPECT_EQ(solver_->solve(rest, solution_), StepStatus::kSolved);
  QpProblem crossed = k.problem;
  crossed.lb[1] = 1.0;
  crossed.ub[1] = 0.5;
  EXPECT_EQ(solver_->solve(crossed, solution_), StepStatus::kInfeasible);
}

INSTANTIATE_TEST_SUITE_P(All, Solvers, ::testing::ValuesIn(solvers()),
                         [](const auto& solver) { return solver.param.name; });

TEST(Daqp, FreeSlackIsSolvedToItsKnownAccuracy) {
  // lambda_delta = 0 leaves H singular; delta still follows from the tracking rows.
  Rng rng(55);
  const int n = 12, rows = 6;
  for (int trial = 0; trial < 100; ++trial) {
    QpProblem p;
    p.allocate(n, rows);
    p.rows = rows;
    p.H << VectorX::Constant(6, 0.01), VectorX::Zero(6);
    p.g.head(6) = VectorX::NullaryExpr(6, [&] { return uniform(rng, -0.1, 0.1); });
    p.A.leftCols(6) = MatrixX::NullaryExpr(6, 6, [&] { return uniform(rng, -1, 1); });
    p.A.rightCols(6).setIdentity();
    p.lbA = p.ubA = VectorX::NullaryExpr(6, [&] { return uniform(rng, -1, 1); });
    p.lb << VectorX::Constant(6, -2), VectorX::Constant(6, -kInfinity);
    p.ub = -p.lb;
    const auto solver = make_solver();
    solver->allocate(n, rows);
    QpSolution s;
    s.allocate(n, rows);
    ASSERT_EQ(solver->solve(p, s), StepStatus::kSolved);
    // With delta free qdot minimises its own cost alone: -g/H, clipped.
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(s.x[i], std::clamp(-p.g[i] / 0.01, -2.0, 2.0), 1e-4) << "trial " << trial;
    EXPECT_LT(kkt_residual(p, s.x, s.bound_multipliers, s.row_multipliers), 1e-6);
  }
}

TEST(KktResidual, SeesEveryKindOfViolation) {
  QpProblem p;
  p.allocate(1, 1);
  p.rows = 1;
  p.H << 2;
  p.g << -2;
  p.A << 1;
  p.lb << -5;
  p.ub << 5;
  p.lbA << -kInfinity;
  p.ubA << 0.5;
  const auto v = [](double x) { return VectorX::Constant(1, x); };
  EXPECT_NEAR(kkt_residual(p, v(0.5), v(0), v(1)), 0.0, 1e-15) << "the optimum: 2 x 0.5 - 2 + 1 = 0";
  EXPECT_GT(kkt_residual(p, v(1), v(0), v(0)), 0.4) << "outside its row";
  EXPECT_GT(kkt_residual(p, v(0.4), v(0), v(0)), 0.5) << "not stationary";
  EXPECT_GT(kkt_residual(p, v(0), v(0), v(2)), 0.5) << "multiplier away from its limit";
  p.g << 0;
  EXPECT_GT(kkt_residual(p, v(0.5), v(0), v(-1)), 0.5) << "wrong sign";
}

}  // namespace
}  // namespace moma
