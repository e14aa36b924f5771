#pragma once

#include <memory>

#include "controller/params.h"
#include "controller/qp/problem.h"
#include "controller/solver/solver.h"
#include "controller/step.h"

namespace moma {

/// Solves the problem, and where that fails its relaxations, in this order:
///  1. relaxed: one common slack s >= 0 on all passing rows, at cost 1/2 1e6 s^2 (skipped without such rows): they look
///     ahead, and must not cost the rows that hold now;
///  2. no_acceleration: the original without acceleration bounds (skipped where there are none);
///  3. relaxed: also the slack on all collision and passing rows (skipped without such rows);
///  4. brake: x = clip(0, lb, ub) in the original bounds, acceleration included; delta = 0.
/// Every workspace is sized for the largest stage by allocate(); solve() takes no memory with a real-time safe solver.
class FallbackSolver {
 public:
  struct Outcome {
    StepStatus status = StepStatus::kSolved;  ///< of the original problem
    Fallback fallback = Fallback::kNone;
    int iterations = 0;            ///< all stages together
    double collision_slack = 0.0;  ///< s of the relaxed stage [m/s]
    bool only_passing = false;     ///< relaxed, the passing rows alone and within the acceleration bounds

    /// Whether the command had room beyond the acceleration bounds.
    bool beyond_acceleration() const noexcept {
      return fallback == Fallback::kNoAcceleration || (fallback == Fallback::kRelaxed && !only_passing);
    }
    /// Whether rows of this kind had the slack.
    bool relaxes(RowKind kind) const noexcept;
  };

  explicit FallbackSolver(SolverKind kind);

  void allocate(int num_variables, int max_rows);

  /// @param hard_lower, hard_upper num_velocities bounds without acceleration; problem.lb and .ub hold those with.
  /// An invalid problem goes to the brake at once.
  Outcome solve(const QpProblem& problem, const VectorX& hard_lower, const VectorX& hard_upper,
                bool has_acceleration) noexcept;

  /// x of the stage that succeeded (n values, then s for the relaxed stage); zero multipliers for the brake.
  const QpSolution& solution() const noexcept { return solution_; }
  /// The problem that was solved in the end, with its own bounds; for the brake the original. Allocates.
  QpProblem final_problem(const QpProblem& original) const;

 private:
  bool relax(const QpProblem& problem, bool only_passing, Outcome& out) noexcept;

  std::unique_ptr<QpSolver> solver_;
  std::unique_ptr<QpSolver> relaxed_solver_;
  QpProblem relaxed_;
  QpSolution solution_;
  VectorX stage_lower_, stage_upper_;
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

/// clip(0, lower, upper), 0 where a bound is not a number or infinite on the wrong side.
double braking(double lower, double upper) noexcept;

}  // namespace moma
