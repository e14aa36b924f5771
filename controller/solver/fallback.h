#pragma once

#include <memory>

#include "controller/params.h"
#include "controller/qp/limits.h"
#include "controller/qp/problem.h"
#include "controller/solver/solver.h"
#include "controller/step.h"

namespace moma {

/// Solves the problem or, if that fails, its relaxations in this order:
///  1. relaxed: one common slack s >= 0 on all separation rows, at cost 1/2 1e6 s^2 (skipped without such
///     rows): rows with a longer horizon give way to rows that hold now;
///  2. no_acceleration: the original without acceleration bounds (skipped if there are none);
///  3. relaxed: the slack on all collision rows and the row of the tilt as well (skipped without such rows);
///  4. brake: x = clip(0, lb, ub) in the original bounds, acceleration included; delta = 0.
/// With Relaxation::kBackup, stage 3 has two slacks. With u_b the smallest command within the stage's bounds, rows of
/// resting objects, floor and self give way by s g_r / max g, g_r = max(0, c_r u_b - zeta_r), s >= 0 at cost 1/2 1e6
/// s^2: full braking, s = max g, is a solution. Rows of moving objects and separation rows share the other slack.
/// allocate() sizes every workspace for the largest stage; solve() does not allocate with DAQP.
class FallbackSolver {
 public:
  struct Outcome {
    StepStatus status = StepStatus::kSolved;  ///< of the original problem
    Fallback fallback = Fallback::kNone;
    int iterations = 0;            ///< sum of all stages
    double collision_slack = 0.0;  ///< largest relaxation of a row in the relaxed stage [m/s]
    bool only_separation = false;  ///< relaxed, only separation rows, within the acceleration bounds

    /// True if the command could exceed the acceleration bounds.
    bool beyond_acceleration() const noexcept {
      return fallback == Fallback::kNoAcceleration || (fallback == Fallback::kRelaxed && !only_separation);
    }
  };

  explicit FallbackSolver(SolverMaker make, Relaxation relaxation = Relaxation::kCommon);

  void allocate(int num_variables, int max_rows);

  /// @param hard_lower, hard_upper num_velocities bounds without acceleration; problem.lb and .ub include it. `pair`:
  /// see smallest_command(). An invalid problem goes to the brake at once.
  Outcome solve(const QpProblem& problem, const VectorX& hard_lower, const VectorX& hard_upper, bool has_acceleration,
                const LinearPair& pair = {}) noexcept;

  /// x of the successful stage (n values, then the slacks of the relaxed stage); zero multipliers for the brake.
  const QpSolution& solution() const noexcept { return solution_; }
  /// Relaxation of this row in the successful stage [m/s]; 0 if it is not relaxed.
  double given(int row) const noexcept;
  /// Returns the problem of the successful stage with its own bounds; for the brake the original. Allocates.
  QpProblem final_problem(const QpProblem& original) const;

 private:
  bool relax(const QpProblem& problem, bool only_separation, Outcome& out) noexcept;
  void weigh_by_backup(const QpProblem& problem) noexcept;

  std::unique_ptr<QpSolver> solver_;
  std::unique_ptr<QpSolver> relaxed_solver_;
  QpProblem relaxed_;
  QpSolution solution_;
  VectorX stage_lower_, stage_upper_;
  VectorX backup_;  // u_b
  LinearPair pair_;
  int slacks_;
  int num_velocities_ = 0;
  Fallback last_ = Fallback::kNone;
};

}  // namespace moma
