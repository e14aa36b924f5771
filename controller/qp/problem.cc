#include "controller/qp/problem.h"

#include <algorithm>
#include <cmath>

#include "controller/model/base_kind.h"

namespace moma {

void QpProblem::allocate(int num_variables, int max_rows) {
  *this = {};  // Eigen frees an array before it takes a larger one, and would free it again where there is none
  H = g = lb = ub = VectorX::Zero(num_variables);
  A = RowMatrix::Zero(max_rows, num_variables);
  lbA = ubA = VectorX::Zero(max_rows);
  ids.resize(static_cast<std::size_t>(max_rows));
}

void QpProblem::clear() noexcept {
  H.setZero();
  g.setZero();
  rows = 0;
}

int QpProblem::append(const RowId& id, double lower, double upper) noexcept {
  if (rows >= capacity()) return -1;
  A.row(rows).setZero();
  lbA[rows] = lower;
  ubA[rows] = upper;
  ids[static_cast<std::size_t>(rows)] = id;
  return rows++;
}

bool QpProblem::append(const RowId& id, double lower, double upper, const Eigen::Ref<const VectorX>& row) noexcept {
  const int at = append(id, lower, upper);
  if (at >= 0) A.row(at).head(row.size()) = row.transpose();
  return at >= 0;
}

double QpProblem::cost(const Eigen::Ref<const VectorX>& x) const noexcept {
  double sum = 0.0;
  for (int i = 0; i < n(); ++i) sum += (0.5 * H[i] * x[i] + g[i]) * x[i];
  return sum;
}

std::string row_name(const RowId& id, const RobotModel& model, std::span<const std::string> object_names) {
  const auto shape = [&](int i) { return model.shape(i).name; };
  switch (id.kind) {
    case RowKind::kTracking:
      return std::string("tracking/") + std::to_string(id.first);
    case RowKind::kObject:
      return "object/" + object_names[static_cast<std::size_t>(id.second)] + "/" + shape(id.first);
    case RowKind::kFloor:
      return "floor/" + shape(id.first);
    case RowKind::kSelf:
      return "self/" + shape(id.first) + "/" + shape(id.second);
    case RowKind::kSeparation:
      return "separation/" + object_names[static_cast<std::size_t>(id.second)] + "/" + shape(id.first);
    case RowKind::kDrive:
      return id.first == 0 ? "drive/+" : "drive/-";
    case RowKind::kWheel:
      return "wheel/" + std::string(kind_of(model.base.type).wheel_names[static_cast<std::size_t>(id.first)]);
    case RowKind::kUpright:
      return "upright";
  }
  return "?";
}

namespace {

// Violation, wrong sign and complementarity of one limited value.
double limit_residual(double value, double lower, double upper, double multiplier) {
  double worst = std::max({0.0, lower - value, value - upper});
  // A multiplier at an infinite limit has no constraint to act on.
  const double gap = multiplier > 0 ? upper - value : value - lower;
  if (multiplier != 0.0) worst = std::max(worst, std::isinf(gap) ? std::abs(multiplier) : std::abs(multiplier * gap));
  return worst;
}

}  // namespace

double kkt_residual(const QpProblem& p, const VectorX& x, const VectorX& bound_multipliers,
                    const VectorX& row_multipliers) {
  const int n = p.n();
  VectorX gradient = p.H.cwiseProduct(x.head(n)) + p.g + bound_multipliers.head(n);
  const VectorX Ax = p.A.topRows(p.rows) * x.head(n);
  gradient += p.A.topRows(p.rows).transpose() * row_multipliers.head(p.rows);
  double worst = n > 0 ? gradient.lpNorm<Eigen::Infinity>() : 0.0;
  for (int i = 0; i < n; ++i) worst = std::max(worst, limit_residual(x[i], p.lb[i], p.ub[i], bound_multipliers[i]));
  for (int i = 0; i < p.rows; ++i)
    worst = std::max(worst, limit_residual(Ax[i], p.lbA[i], p.ubA[i], row_multipliers[i]));
  return worst;
}

}  // namespace moma
