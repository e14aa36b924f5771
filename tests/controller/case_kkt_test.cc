#include "tests/support/kkt.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace moma {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

struct Qp {
  MatrixX Q, A;
  VectorX c, lbA, ubA, lb, ub, x;
  QpView view() const { return {Q, c, A, lbA, ubA, lb, ub}; }
};

double uniform(std::mt19937_64& rng, double low, double high) {
  return low + (high - low) * static_cast<double>(rng() >> 11) * 0x1p-53;
}

// A problem built around its solution: some rows and bounds active with multipliers of the right sign, the others
// with room to spare, and c chosen to balance them.
Qp problem_with_known_solution(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  const int m = 3 + static_cast<int>(seed % 12), r = static_cast<int>(seed % 9);
  Qp p;
  p.Q = MatrixX::Zero(m, m);
  p.A = MatrixX::Zero(r, m);
  p.x = VectorX::Zero(m);
  for (int i = 0; i < m; ++i) {
    p.Q(i, i) = uniform(rng, 0.01, 5.0);
    p.x[i] = uniform(rng, -2.0, 2.0);
    for (int j = 0; j < r; ++j) p.A(j, i) = uniform(rng, -1.0, 1.0);
  }
  VectorX multiplier_sum = VectorX::Zero(m);
  const auto limits = [&](double value, double& low, double& high) {
    low = value - uniform(rng, 0.1, 1.0);
    high = value + uniform(rng, 0.1, 1.0);
    switch (rng() % 5) {
      case 0:
        low = value;
        return uniform(rng, 0.01, 2.0);
      case 1:
        high = value;
        return -uniform(rng, 0.01, 2.0);
      case 2:
        low = high = value;
        return uniform(rng, -2.0, 2.0);
      case 3:
        low = -kInf;
        return 0.0;
      default:
        return 0.0;
    }
  };
  p.lbA = p.ubA = VectorX::Zero(r);
  p.lb = p.ub = VectorX::Zero(m);
  const VectorX Ax = p.A * p.x;
  for (int j = 0; j < r; ++j) multiplier_sum += limits(Ax[j], p.lbA[j], p.ubA[j]) * p.A.row(j).transpose();
  for (int i = 0; i < m; ++i) multiplier_sum[i] += limits(p.x[i], p.lb[i], p.ub[i]);
  p.c = multiplier_sum - p.Q * p.x;
  return p;
}

TEST(CaseKkt, AcceptsKnownSolutions) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    const Qp p = problem_with_known_solution(seed);
    EXPECT_LT(check_kkt(p.view(), p.x).residual(), 1e-9) << "seed " << seed;
  }
}

TEST(CaseKkt, RefusesPointsNearby) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    Qp p = problem_with_known_solution(seed);
    std::mt19937_64 rng(seed);
    // The problem is strictly convex: no other point satisfies the conditions, and moving by h shows at least
    // as h times the smallest curvature.
    for (int i = 0; i < p.x.size(); ++i) p.x[i] += 1e-3 * (rng() % 2 == 0 ? 1.0 : -1.0);
    EXPECT_GT(check_kkt(p.view(), p.x).residual(), 1e-7) << "seed " << seed;
  }
}

TEST(CaseKkt, RefusesAMultiplierOfTheWrongSign) {
  // min 1/2 x^2 - x with x >= 0: x = 0 is feasible, and the bound would have to pull.
  Qp p;
  p.Q = MatrixX::Ones(1, 1);
  p.c = -VectorX::Ones(1);
  p.A = MatrixX::Zero(0, 1);
  p.lbA = p.ubA = VectorX::Zero(0);
  p.lb = VectorX::Zero(1);
  p.ub = VectorX::Constant(1, kInf);
  const KktReport bad = check_kkt(p.view(), VectorX::Zero(1));
  EXPECT_EQ(bad.primal, 0.0);
  EXPECT_NEAR(bad.stationarity, 1.0, 1e-12);
  EXPECT_LT(check_kkt(p.view(), VectorX::Ones(1)).residual(), 1e-12);
}

TEST(CaseKkt, ReportsViolationsAndNan) {
  const Qp p = problem_with_known_solution(4);
  VectorX x = p.x;
  x[0] = 1e3;
  EXPECT_GT(check_kkt(p.view(), x).residual(), 1.0);
  x[0] = std::nan("");
  EXPECT_TRUE(std::isinf(check_kkt(p.view(), x).residual()));
}

TEST(CaseKkt, LeastSquaresIsNonNegativeAndOptimal) {
  std::mt19937_64 rng(7);
  for (int trial = 0; trial < 300; ++trial) {
    const int rows = 2 + trial % 7, columns = 1 + trial % 11;
    MatrixX E(rows, columns);
    VectorX f(rows);
    for (int i = 0; i < rows; ++i) {
      f[i] = uniform(rng, -1.0, 1.0);
      for (int j = 0; j < columns; ++j) E(i, j) = uniform(rng, -1.0, 1.0);
    }
    if (columns > 1 && trial % 3 == 0) E.col(1) = -E.col(0);  // the two sides of an equality
    const VectorX u = nonnegative_least_squares(E, f);
    const VectorX w = E.transpose() * (f - E * u);
    for (int j = 0; j < columns; ++j) {
      EXPECT_GE(u[j], 0.0);
      EXPECT_LT(w[j], 1e-9) << "trial " << trial << ": growing u[" << j << "] would help";
      EXPECT_LT(std::abs(u[j] * w[j]), 1e-9) << "trial " << trial;
    }
  }
}

}  // namespace
}  // namespace moma
