#include "controller/solver/fallback.h"

#include <algorithm>

namespace moma {
namespace {

constexpr double kSlackCost = 1e6;

bool is_soft(RowKind kind, bool only_separation) noexcept {
  return kind == RowKind::kSeparation || (!only_separation && (is_collision(kind) || kind == RowKind::kUpright));
}

bool has_soft(const QpProblem& problem, bool only_separation) noexcept {
  return std::any_of(problem.ids.begin(), problem.ids.begin() + problem.rows,
                     [&](const RowId& id) { return is_soft(id.kind, only_separation); });
}

}  // namespace

FallbackSolver::FallbackSolver(SolverMaker make, Relaxation relaxation)
    : solver_(make()), relaxed_solver_(make()), slacks_(relaxation == Relaxation::kBackup ? 2 : 1) {}

void FallbackSolver::allocate(int num_variables, int max_rows) {
  solver_->allocate(num_variables, max_rows);
  relaxed_solver_->allocate(num_variables + slacks_, max_rows);
  relaxed_.allocate(num_variables + slacks_, max_rows);
  solution_.allocate(num_variables + slacks_, max_rows);
  stage_lower_ = VectorX::Zero(num_variables);
  stage_upper_ = VectorX::Zero(num_variables);
  backup_ = VectorX::Zero(num_variables);
  last_ = Fallback::kNone;
}

FallbackSolver::Outcome FallbackSolver::solve(const QpProblem& problem, const VectorX& hard_lower,
                                              const VectorX& hard_upper, bool has_acceleration,
                                              const LinearPair& pair) noexcept {
  Outcome out;
  pair_ = pair;
  num_velocities_ = static_cast<int>(hard_lower.size());
  last_ = Fallback::kNone;
  out.status = solver_->solve(problem, solution_);
  out.iterations = solution_.iterations;
  if (out.status == StepStatus::kSolved) return out;

  if (out.status != StepStatus::kInvalidInput) {
    stage_lower_ = problem.lb;
    stage_upper_ = problem.ub;
    if (has_soft(problem, true) && relax(problem, true, out)) return out;
    stage_lower_.head(hard_lower.size()) = hard_lower;
    stage_upper_.head(hard_upper.size()) = hard_upper;
    if (has_acceleration) {
      const StepStatus status = solver_->solve(problem, {stage_lower_.data(), stage_upper_.data()}, solution_);
      out.iterations += solution_.iterations;
      if (status == StepStatus::kSolved) {
        out.fallback = last_ = Fallback::kNoAcceleration;
        return out;
      }
    }
    if (has_soft(problem, false) && relax(problem, false, out)) return out;
  }

  out.fallback = last_ = Fallback::kBrake;
  const auto nv = hard_lower.size();
  solution_.x.setZero();
  smallest_command(problem.lb.head(nv), problem.ub.head(nv), pair, solution_.x.head(nv));
  solution_.bound_multipliers.setZero();
  solution_.row_multipliers.setZero();
  return out;
}

bool FallbackSolver::relax(const QpProblem& problem, bool only_separation, Outcome& out) noexcept {
  const int n = problem.n();
  relaxed_.H.head(n) = problem.H;
  relaxed_.g.head(n) = problem.g;
  relaxed_.lb.head(n) = stage_lower_;
  relaxed_.ub.head(n) = stage_upper_;
  relaxed_.H.tail(slacks_).setConstant(kSlackCost);
  relaxed_.g.tail(slacks_).setZero();
  relaxed_.lb.tail(slacks_).setZero();
  relaxed_.ub.tail(slacks_).setConstant(kInfinity);
  relaxed_.rows = problem.rows;
  relaxed_.A.topLeftCorner(problem.rows, n) = problem.A.topRows(problem.rows);
  relaxed_.lbA.head(problem.rows) = problem.lbA.head(problem.rows);
  relaxed_.ubA.head(problem.rows) = problem.ubA.head(problem.rows);
  for (int i = 0; i < problem.rows; ++i) {
    const RowId& id = problem.ids[static_cast<std::size_t>(i)];
    relaxed_.ids[static_cast<std::size_t>(i)] = id;
    relaxed_.A(i, n) = is_soft(id.kind, only_separation) ? -1.0 : 0.0;
    if (slacks_ == 2) relaxed_.A(i, n + 1) = 0.0;
  }
  if (slacks_ == 2 && !only_separation) weigh_by_backup(problem);
  const StepStatus status = relaxed_solver_->solve(relaxed_, solution_);
  out.iterations += solution_.iterations;
  if (status != StepStatus::kSolved) return false;
  out.fallback = last_ = Fallback::kRelaxed;
  for (int i = 0; i < problem.rows; ++i) out.collision_slack = std::max(out.collision_slack, given(i));
  out.only_separation = only_separation;
  return true;
}

void FallbackSolver::weigh_by_backup(const QpProblem& problem) noexcept {
  const int n = problem.n();
  const int nv = num_velocities_;
  smallest_command(stage_lower_.head(nv), stage_upper_.head(nv), pair_, backup_.head(nv));
  double worst = 0.0;
  for (int i = 0; i < problem.rows; ++i) {
    const RowId& id = problem.ids[static_cast<std::size_t>(i)];
    if (!is_soft(id.kind, false)) continue;
    if (id.moves || id.kind == RowKind::kSeparation) {
      relaxed_.A(i, n) = 0.0;
      relaxed_.A(i, n + 1) = -1.0;
      continue;
    }
    double braked = 0.0;
    for (int j = 0; j < nv; ++j) braked += problem.A(i, j) * backup_[j];
    const double broken = std::max(0.0, braked - problem.ubA[i]);
    relaxed_.A(i, n) = -broken;
    worst = std::max(worst, broken);
  }
  // In units of the most violated row [m/s], because the solver takes small coefficients for zero.
  if (worst > 0.0) relaxed_.A.col(n).head(problem.rows) /= worst;
}

double FallbackSolver::given(int row) const noexcept {
  if (last_ != Fallback::kRelaxed) return 0.0;
  double sum = 0.0;
  for (Eigen::Index k = relaxed_.n() - slacks_; k < relaxed_.n(); ++k) sum -= relaxed_.A(row, k) * solution_.x[k];
  return sum;
}

QpProblem FallbackSolver::final_problem(const QpProblem& original) const {
  if (last_ == Fallback::kRelaxed) return relaxed_;
  QpProblem problem = original;
  if (last_ == Fallback::kNoAcceleration) {
    problem.lb = stage_lower_;
    problem.ub = stage_upper_;
  }
  return problem;
}

}  // namespace moma
