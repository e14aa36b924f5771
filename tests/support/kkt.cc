#include "tests/support/kkt.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace moma {
namespace {

// One side of a row or bound that the solution touches; its gradient in x is +column at a lower side.
struct Side {
  int index;    // row, or r + variable
  double sign;  // +1 at the lower side, -1 at the upper
  double gap;   // distance of the solution from the side
};

void collect(int index, double value, double lower, double upper, double tolerance, std::vector<Side>& sides) {
  const auto near = [&](double side) {
    return std::isfinite(side) && std::abs(value - side) <= tolerance * (1.0 + std::abs(side));
  };
  if (near(lower)) sides.push_back({index, 1.0, std::abs(value - lower)});
  if (near(upper)) sides.push_back({index, -1.0, std::abs(value - upper)});
}

double violation(double value, double lower, double upper) { return std::max({0.0, lower - value, value - upper}); }

}  // namespace

double KktReport::residual() const noexcept { return std::max({primal, stationarity, complementarity}); }

VectorX nonnegative_least_squares(const MatrixX& E, const VectorX& f) {
  const Eigen::Index n = E.cols();
  VectorX u = VectorX::Zero(n);
  if (n == 0) return u;
  std::vector<Eigen::Index> passive;
  const double tolerance = 1e-13 * (1.0 + E.cwiseAbs().maxCoeff()) * (1.0 + f.cwiseAbs().maxCoeff());
  for (Eigen::Index iteration = 0; iteration < 10 * n + 10; ++iteration) {
    const VectorX w = E.transpose() * (f - E * u);
    Eigen::Index enter = -1;
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool inside = std::find(passive.begin(), passive.end(), i) != passive.end();
      if (!inside && w[i] > tolerance && (enter < 0 || w[i] > w[enter])) enter = i;
    }
    if (enter < 0) return u;
    passive.push_back(enter);
    while (!passive.empty()) {
      MatrixX part(E.rows(), static_cast<Eigen::Index>(passive.size()));
      for (std::size_t k = 0; k < passive.size(); ++k) part.col(static_cast<Eigen::Index>(k)) = E.col(passive[k]);
      const VectorX s = part.completeOrthogonalDecomposition().solve(f);
      double step = 1.0;
      for (std::size_t k = 0; k < passive.size(); ++k) {
        const double from = u[passive[k]], to = s[static_cast<Eigen::Index>(k)];
        if (to <= 0.0) step = std::min(step, from / std::max(from - to, std::numeric_limits<double>::min()));
      }
      for (std::size_t k = 0; k < passive.size(); ++k) {
        u[passive[k]] += step * (s[static_cast<Eigen::Index>(k)] - u[passive[k]]);
      }
      if (step >= 1.0) break;
      std::erase_if(passive, [&](Eigen::Index i) {
        if (u[i] > 1e-15) return false;
        u[i] = 0.0;
        return true;
      });
    }
  }
  return u;
}

KktReport check_kkt(const QpView& qp, const VectorX& x, double active_tolerance) {
  const Eigen::Index m = qp.Q.rows(), r = qp.A.rows();
  KktReport out;
  out.y = VectorX::Zero(r);
  out.z = VectorX::Zero(m);
  if (!x.allFinite()) {
    out.primal = out.stationarity = out.complementarity = std::numeric_limits<double>::infinity();
    return out;
  }
  const VectorX Ax = qp.A * x;
  std::vector<Side> sides;
  for (Eigen::Index i = 0; i < r; ++i) {
    out.primal = std::max(out.primal, violation(Ax[i], qp.lbA[i], qp.ubA[i]));
    collect(static_cast<int>(i), Ax[i], qp.lbA[i], qp.ubA[i], active_tolerance, sides);
  }
  for (Eigen::Index i = 0; i < m; ++i) {
    out.primal = std::max(out.primal, violation(x[i], qp.lb[i], qp.ub[i]));
    collect(static_cast<int>(r + i), x[i], qp.lb[i], qp.ub[i], active_tolerance, sides);
  }
  const VectorX gradient = qp.Q * x + qp.c;
  MatrixX E = MatrixX::Zero(m, static_cast<Eigen::Index>(sides.size()));
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Eigen::Index column = static_cast<Eigen::Index>(k);
    if (sides[k].index < r) {
      E.col(column) = sides[k].sign * qp.A.row(sides[k].index).transpose();
    } else {
      E(sides[k].index - r, column) = sides[k].sign;
    }
  }
  const VectorX u = nonnegative_least_squares(E, gradient);
  out.stationarity = (gradient - E * u).cwiseAbs().maxCoeff();
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const double multiplier = u[static_cast<Eigen::Index>(k)];
    (sides[k].index < r ? out.y[sides[k].index] : out.z[sides[k].index - r]) += sides[k].sign * multiplier;
    out.complementarity = std::max(out.complementarity, multiplier * sides[k].gap);
  }
  return out;
}

}  // namespace moma
