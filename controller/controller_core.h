#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controller/closed_form/closed_form.h"
#include "controller/memory.h"
#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/params.h"
#include "controller/part_clock.h"
#include "controller/qp/collision.h"
#include "controller/qp/limits.h"
#include "controller/qp/passing.h"
#include "controller/qp/problem.h"
#include "controller/qp/separation.h"
#include "controller/safe/brake_check.h"
#include "controller/safe/predictor.h"
#include "controller/solver/fallback.h"
#include "controller/step.h"
#include "controller/task/escape.h"
#include "controller/task/servo.h"

namespace moma {

class Evasion;
class Lookahead;

/// Controller (controller.h) with its parts open: for what looks into a step, goes on from a memory, or tests one. Not
/// installed. Accessors describe the last step; those marked "allocates" are for inspection.
class ControllerCore final : public StepController {
 public:
  ControllerCore(std::shared_ptr<const RobotModel> model, ControllerParams params, double control_period);
  ~ControllerCore() override;

  void reset(std::span<const ObjectShape> objects) override;
  void step(const Observation& observation, StepResult& result) noexcept override;
  void prepare(StepResult& result) const override;

  /// Fills StepResult::solve_seconds from the steady clock; off by default.
  void enable_timing(bool on) noexcept { timing_ = on; }
  /// See Controller.
  void set_clock(StepClock* clock) noexcept { clock_ = clock; }

  const RobotModel& model() const noexcept { return *model_; }
  const ControllerParams& params() const noexcept { return params_; }
  double control_period() const noexcept { return control_period_; }
  const Kinematics& kinematics() const noexcept { return kinematics_; }
  const Task& task() const noexcept { return task_; }
  const Vector6& nu() const noexcept { return task_.nu; }
  double theta_eps() const noexcept { return task_.theta_eps; }
  const Matrix6X& J() const noexcept { return kinematics_.J_WE_W(); }
  double manipulability() const noexcept { return manipulability_; }
  /// Gradient of the manipulability, one value per joint, whatever its weight is. Allocates.
  VectorX J_m() const;
  /// The problem as posed (acceleration bounds included); no rows and zero H for the closed-form methods.
  const QpProblem& problem() const noexcept { return problem_; }
  std::string row_name(int row) const;
  const FallbackSolver::Outcome& outcome() const noexcept { return outcome_; }
  /// The solver's x (qdot before output scaling, delta), and s after the relaxed stage. Empty for closed forms.
  const QpSolution& solution() const;
  /// 1/2 x^T H x + g^T x of the problem as posed, at the solution; constants and s left out.
  double cost() const noexcept;
  /// Residual of the optimality conditions of the stage that was solved; infinite for the brake. Allocates.
  double kkt_residual() const;
  /// The problem of the stage that gave the command, with its own bounds; the original for the brake. Allocates.
  QpProblem final_problem() const { return fallback_.final_problem(problem_); }
  /// Pairs within their influence, nearest first by d - d_s.
  std::span<const ProximityPair> distances() const noexcept { return collision_.sorted(); }
  /// What of that is about detours; all zero where nothing of escape.h is on.
  const EscapeState& escape_state() const noexcept { return escape_.state(); }
  /// Goes on from such a state; after reset(), which clears it.
  void set_escape_state(const EscapeState& state) noexcept { escape_.set_state(state); }
  /// All that the controller remembers between steps. `memory` is written without taking memory if it was before, with
  /// as many objects.
  void get_memory(ControllerMemory& memory) const;
  /// Goes on from what a controller of the same parameters remembered among as many objects; after reset(), which
  /// clears it. Takes no memory. What the next step does is a function of this and its observation.
  void set_memory(const ControllerMemory& memory) noexcept;
  /// Looking ahead: its state, its last choice, its plans; nothing where `plan` is off.
  const Lookahead* lookahead() const noexcept { return lookahead_.get(); }
  Lookahead* lookahead() noexcept { return lookahead_.get(); }
  const std::vector<std::string>& object_names() const noexcept { return object_names_; }
  /// Wheel speeds [rad/s] of the last command: left, right or FL, FR, RL, RR; empty without wheels. Allocates.
  VectorX wheels() const;
  const StepCounters& counters() const noexcept { return counters_; }
  /// Whether the last step's base drove off (safe/evasion.h) instead of doing what the QP asked of it.
  bool evades() const noexcept { return evades_; }

 private:
  bool valid(const Observation& observation) const noexcept;
  void brake(const Observation& observation, StepResult& result) noexcept;
  void observe(const Observation& observation) noexcept;
  void build(const Observation& observation) noexcept;
  void look_ahead(const Observation& observation) noexcept;
  void ask_for(const VectorX& velocities, const Observation& observation) noexcept;
  void solve_qp(const Observation& observation, StepResult& result) noexcept;
  bool drive_base(const Observation& observation, StepResult& result) noexcept;
  void hold_base() noexcept;
  void solve_closed_form(const Observation& observation, StepResult& result) noexcept;
  void bound_acceleration(const VectorX& qdot) noexcept;
  void evade(const Observation& observation, StepResult& result) noexcept;
  void add_terms(const Observation& observation) noexcept;
  void check_braking(const Observation& observation, StepResult& result) noexcept;
  void send(StepResult& result) noexcept;
  void scale_output() noexcept;
  int count_active() const noexcept;

  std::shared_ptr<const RobotModel> model_;
  ControllerParams params_;
  double control_period_;
  bool timing_ = false;
  StepClock* clock_ = nullptr;
  int base_dof_, nv_;

  Kinematics kinematics_;
  Proximity proximity_;
  CollisionRows collision_;
  PassingRows passing_;
  SeparationRows separation_;
  Predictor predictor_;
  BrakeCheck check_;
  Escape escape_;
  VelocityBounds bounds_;
  FallbackSolver fallback_;
  DampedInverse inverse_;

  PostureParams detour_posture_;
  Eigen::VectorXi prismatic_;
  std::vector<std::string> object_names_;
  Task task_;
  double manipulability_ = 0.0;
  VectorX J_m_;
  VectorX hard_lower_, hard_upper_;
  LinearPair pair_;
  QpProblem problem_;
  FallbackSolver::Outcome outcome_;
  VectorX command_, gradient_, scratch_;
  StepCounters counters_;
  std::unique_ptr<Evasion> evasion_;  // null where there is none
  bool evades_ = false;
  std::unique_ptr<Lookahead> lookahead_;
  EscapeState begun_with_;  // of this step
};

}  // namespace moma
