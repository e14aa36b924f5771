#include "controller/qp/tracking.h"

namespace moma {

void add_tracking_rows(const Matrix6X& J_WE_W, const Vector6& nu, const Vector6& band, bool slack,
                       QpProblem& problem) noexcept {
  const int nv = static_cast<int>(J_WE_W.cols());
  for (int i = 0; i < 6; ++i) {
    const int row = problem.append({RowKind::kTracking, i, -1}, nu[i] - band[i], nu[i] + band[i]);
    if (row < 0) return;
    for (int j = 0; j < nv; ++j) problem.A(row, j) = J_WE_W(i, j);
    if (slack) problem.A(row, nv + i) = 1.0;
  }
}

}  // namespace moma
