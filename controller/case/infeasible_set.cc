#include "controller/case/infeasible_set.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "controller/params.h"
#include "controller/solver/solver.h"

namespace moma {
namespace {

// Returns true if some x meets the kept constraints: a QP looks for the smallest such x.
class FeasibilityCheck {
 public:
  explicit FeasibilityCheck(const QpProblem& problem) : given_(&problem), solver_(make_solver()) {
    part_.allocate(problem.n(), std::max(problem.rows, 1));
    solution_.allocate(problem.n(), std::max(problem.rows, 1));
    solver_->allocate(problem.n(), std::max(problem.rows, 1));
  }

  StepStatus status(const std::vector<ConstraintId>& all, const std::vector<bool>& kept) {
    part_.clear();
    part_.H.setOnes();
    part_.lb.setConstant(-kInfinity);
    part_.ub.setConstant(kInfinity);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!kept[i]) continue;
      const int k = all[i].index;
      switch (all[i].kind) {
        case ConstraintId::Kind::kRow:
          part_.append(given_->ids[static_cast<std::size_t>(k)], given_->lbA[k], given_->ubA[k],
                       given_->A.row(k).transpose());
          break;
        case ConstraintId::Kind::kLowerBound:
          part_.lb[k] = given_->lb[k];
          break;
        case ConstraintId::Kind::kUpperBound:
          part_.ub[k] = given_->ub[k];
          break;
      }
    }
    return solver_->solve(part_, solution_);
  }

 private:
  const QpProblem* given_;
  std::unique_ptr<QpSolver> solver_;
  QpProblem part_;
  QpSolution solution_;
};

// In the order in which they are tried for deletion. What goes last tends to stay: bounds where `rows_first`.
std::vector<ConstraintId> list_constraints(const QpProblem& p, int num_velocities, bool rows_first) {
  std::vector<ConstraintId> all;
  const auto add_rows = [&](bool tracking) {
    // The farthest of a kind first: it is the least likely to matter.
    for (int i = p.rows - 1; i >= 0; --i)
      if ((p.ids[static_cast<std::size_t>(i)].kind == RowKind::kTracking) == tracking)
        all.push_back({ConstraintId::Kind::kRow, i});
  };
  const auto add_bounds = [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      if (std::isfinite(p.lb[i])) all.push_back({ConstraintId::Kind::kLowerBound, i});
      if (std::isfinite(p.ub[i])) all.push_back({ConstraintId::Kind::kUpperBound, i});
    }
  };
  add_rows(true);
  add_bounds(num_velocities, p.n());
  if (rows_first) add_rows(false);
  add_bounds(0, num_velocities);
  if (!rows_first) add_rows(false);
  return all;
}

// Drops, in the given order, every constraint without which the rest is still infeasible; returns the rest.
std::vector<ConstraintId> filter(const QpProblem& problem, const std::vector<ConstraintId>& all) {
  std::vector<bool> kept(all.size(), true);
  FeasibilityCheck check(problem);
  if (check.status(all, kept) != StepStatus::kInfeasible) return {};
  for (std::size_t i = 0; i < all.size(); ++i) {
    kept[i] = false;
    if (check.status(all, kept) != StepStatus::kInfeasible) kept[i] = true;
  }
  std::vector<ConstraintId> out;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (kept[i]) out.push_back(all[i]);
  return out;
}

}  // namespace

std::vector<ConstraintId> minimal_infeasible_set(const QpProblem& problem, int num_velocities) {
  auto rows = filter(problem, list_constraints(problem, num_velocities, false));
  auto bounds = filter(problem, list_constraints(problem, num_velocities, true));
  return !bounds.empty() && bounds.size() < rows.size() ? bounds : rows;
}

}  // namespace moma
