#pragma once

#include <memory>

#include "controller/params.h"
#include "controller/qp/limits.h"
#include "controller/qp/problem.h"
#include "controller/solver/solver.h"
#include "controller/step.h"

namespace moma {

/// Solves the problem, and where that fails its relaxations, in this order:
///  1. relaxed: one common slack s >= 0 on all passing and separation rows, at cost 1/2 1e6 s^2 (skipped without such
///     rows): they look ahead, and must not cost the rows that hold now;
///  2. no_acceleration: the original without acceleration bounds (skipped where there are none);
///  3. relaxed: the slack on all collision rows as well (skipped without such rows);
///  4. brake: x = clip(0, lb, ub) in the original bounds, acceleration included; delta = 0.
/// With Relaxation::kBackup, 3 has two slacks. With u_b the smallest command of the stage's bounds, rows of resting
/// objects, floor and self give way by s g_r / max g, g_r = max(0, c_r u_b - zeta_r), s >= 0 at cost 1/2 1e6 s^2: full
/// braking, s = max g, is a solution, and what braking keeps is not loosened. Rows of objects in motion, before which
/// standing still is no way out, passing rows and separation rows share the other slack.
/// Every workspace is sized for the largest stage by allocate(); solve() takes no memory with a real-time safe solver.
class FallbackSolver {
 public:
  struct Outcome {
    StepStatus status = StepStatus::kSolved;  ///< of the original problem
    Fallback fallback = Fallback::kNone;
    int iterations = 0;            ///< all stages together
    double collision_slack = 0.0;  ///< what the relaxed stage gives the row that gets most [m/s]
    bool only_passing = false;     ///< relaxed, only rows that look ahead, within the acceleration bounds

    /// Whether the command had room beyond the acceleration bounds.
    bool beyond_acceleration() const noexcept {
      return fallback == Fallback::kNoAcceleration || (fallback == Fallback::kRelaxed && !only_passing);
    }
  };

  explicit FallbackSolver(SolverKind kind, Relaxation relaxation = Relaxation::kCommon);

  void allocate(int num_variables, int max_rows);

  /// @param hard_lower, hard_upper num_velocities bounds without acceleration; problem.lb and .ub hold those with.
  /// `pair`: see smallest_command(). An invalid problem goes to the brake at once.
  Outcome solve(const QpProblem& problem, const VectorX& hard_lower, const VectorX& hard_upper, bool has_acceleration,
                const LinearPair& pair = {}) noexcept;

  /// x of the stage that succeeded (n values, then the slacks of the relaxed stage); zero multipliers for the brake.
  const QpSolution& solution() const noexcept { return solution_; }
  /// What the stage that succeeded gave to this row [m/s]; 0 where it is not relaxed.
  double given(int row) const noexcept;
  /// The problem that was solved in the end, with its own bounds; for the brake the original. Allocates.
  QpProblem final_problem(const QpProblem& original) const;

 private:
  bool relax(const QpProblem& problem, bool only_passing, Outcome& out) noexcept;
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

/// Counts of what the steps since reset() came to.
struct StepCounters {
  long long steps = 0;
  long long solved = 0, infeasible = 0, max_iterations = 0, invalid_input = 0;
  long long no_acceleration = 0, relaxed = 0, brake = 0;
  long long rows_left_out = 0;  ///< collision rows nothing the robot can do would change

  void count(StepStatus status, Fallback fallback, int left_out) noexcept;
};

}  // namespace moma
