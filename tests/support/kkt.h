#pragma once

#include "controller/types.h"

namespace moma {

/// min 1/2 x^T Q x + c^T x  subject to  lbA <= A x <= ubA, lb <= x <= ub; bounds may be infinite.
struct QpView {
  const MatrixX& Q;    ///< m x m, symmetric positive semidefinite
  const VectorX& c;    ///< m
  const MatrixX& A;    ///< r x m
  const VectorX& lbA;  ///< r
  const VectorX& ubA;  ///< r
  const VectorX& lb;   ///< m
  const VectorX& ub;   ///< m
};

struct KktReport {
  double primal = 0.0;               ///< largest violation of a row or bound
  double stationarity = 0.0;         ///< |Q x + c - A^T y - z|_inf at the best multipliers y, z of the right signs
  double complementarity = 0.0;      ///< largest |multiplier| x distance from the side it belongs to
  VectorX y;                         ///< multipliers of the rows: positive at lbA, negative at ubA
  VectorX z;                         ///< multipliers of the bounds, likewise
  double residual() const noexcept;  ///< the largest of the three
};

/// Checks a solution by the Karush-Kuhn-Tucker conditions (Nocedal & Wright, Numerical Optimization, 2006, thm. 12.1)
/// without trusting the solver that found it: the multipliers are computed here, as the non-negative least squares
/// solution (Lawson & Hanson 1974, ch. 23) over the rows and bounds within `active_tolerance` of a side.
/// NaN in x gives infinite residuals. Allocates.
KktReport check_kkt(const QpView& qp, const VectorX& x, double active_tolerance = 1e-7);

/// argmin |E u - f|_2 subject to u >= 0, by the active-set method of Lawson & Hanson.
VectorX nonnegative_least_squares(const MatrixX& E, const VectorX& f);

}  // namespace moma
