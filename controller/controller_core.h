#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "controller/guard/guard.h"
#include "controller/map/seen_map.h"
#include "controller/memory.h"
#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/params.h"
#include "controller/part_clock.h"
#include "controller/policy/policy.h"
#include "controller/qp/pose.h"
#include "controller/qp/problem.h"
#include "controller/safe/predictor.h"
#include "controller/situation.h"
#include "controller/solver/fallback.h"
#include "controller/step.h"
#include "controller/task/escape.h"

namespace moma {

class Lookahead;

/// Controller (controller.h) with accessible stages, for inspection, tests, and continuing from a memory. Not
/// installed. Accessors describe the last step; those marked "allocates" are for inspection.
class ControllerCore final : public StepController {
 public:
  ControllerCore(std::shared_ptr<const RobotModel> model, ControllerParams params, double control_period,
                 SolverMaker make_qp_solver = &make_solver);
  ~ControllerCore() override;

  void reset(std::span<const ObjectShape> objects) override;
  void see(const DepthFrame& frame) noexcept override { map_.see(frame); }
  Gaze gaze(int sensor) const noexcept override { return map_.gaze(sensor); }
  void step(const Observation& observation, StepResult& result) noexcept override;
  void prepare(StepResult& result) const override;

  /// Fills StepResult::solve_seconds from the steady clock; off by default.
  void enable_timing(bool on) noexcept { timing_ = on; }
  void set_clock(StepClock* clock) noexcept { clock_ = clock; }

  const RobotModel& model() const noexcept { return *model_; }
  const ControllerParams& params() const noexcept { return params_; }
  double control_period() const noexcept { return control_period_; }
  /// Kinematics of the state in which the command acts: the predicted one with prediction.
  const Kinematics& kinematics() const noexcept { return assessment_.kinematics(); }
  /// The predicted state as an observation; null without prediction.
  const Observation* predicted() const noexcept { return predictor_.on() ? &predictor_.predicted() : nullptr; }
  /// Task that was solved last: the policy's, or a guard's.
  const Task& task() const noexcept { return answer_.task; }
  const Vector6& nu() const noexcept { return task().nu; }
  double theta_eps() const noexcept { return task().theta_eps; }
  const Matrix6X& J() const noexcept { return kinematics().J_WE_W(); }
  double manipulability() const noexcept { return answer_.manipulability; }
  /// Gradient of the manipulability, one value per joint, for any weight. Allocates.
  VectorX J_m() const { return assessment_.J_m(); }
  const QpTask& asked() const noexcept { return poser_.asked(); }
  /// Bounds of the problem, with and without acceleration.
  const Bounds& bounds() const noexcept { return poser_.bounds(); }
  /// Components of the task's bounds: speed limits, joint limits, accelerations.
  const VelocityBounds& limits() const noexcept { return asked().bounds ? *asked().bounds : poser_.limits(); }
  /// The problem as posed (acceleration bounds included); no rows and zero H for the closed-form methods.
  const QpProblem& problem() const noexcept { return poser_.problem(); }
  std::string row_name(int row) const;
  const FallbackSolver::Outcome& outcome() const noexcept { return answer_.outcome; }
  /// The solver's x (qdot before output scaling, delta), and s after the relaxed stage. Empty for closed forms.
  const QpSolution& solution() const noexcept { return fallback_.solution(); }
  /// 1/2 x^T H x + g^T x of the problem as posed, at the solution, without constants and s.
  double cost() const noexcept { return problem().cost(solution().x); }
  /// Costs of the active terms. Allocates.
  std::vector<TermCost> term_costs() const { return poser_.objective().costs(solution().x); }
  /// Residual of the optimality conditions of the solved stage; infinite for the brake. Allocates.
  double kkt_residual() const;
  /// Problem of the stage that gave the command, with its own bounds; the original for the brake. Allocates.
  QpProblem final_problem() const { return fallback_.final_problem(problem()); }
  /// Pairs within their influence, nearest first by d - d_s.
  std::span<const ProximityPair> distances() const noexcept { return poser_.collision().sorted(); }
  /// Memory of detours; all zero without them.
  const EscapeState& escape_state() const noexcept { return escape_.state(); }
  /// Continues from such a state; call it after reset(), which clears it.
  void set_escape_state(const EscapeState& state) noexcept { escape_.set_state(state); }
  /// Writes the whole memory between steps. Does not allocate if `memory` was written before with as many objects.
  void get_memory(ControllerMemory& memory) const;
  /// Continues from the memory of a controller with the same parameters and number of objects; call it after reset(),
  /// which clears it. Does not allocate. Memory and observation determine the next step.
  void set_memory(const ControllerMemory& memory) noexcept;
  /// Look-ahead with its state, last choice and plans; null if `plan` is off.
  const Lookahead* lookahead() const noexcept { return lookahead_.get(); }
  Lookahead* lookahead() noexcept { return lookahead_.get(); }
  /// Names of the told objects, then of the map's boxes.
  const std::vector<std::string>& object_names() const noexcept { return object_names_; }
  const SeenMap& map() const noexcept { return map_; }
  /// Wheel speeds [rad/s] of the last command: left, right or FL, FR, RL, RR; empty without wheels. Allocates.
  VectorX wheels() const;
  /// Number of collision rows that the last step left out, since no motion of the robot changes them.
  int rows_left_out() const noexcept { return poser_.collision().left_out(); }
  /// Stop distance of the rows of objects at rest in the last step [m].
  double kept_stop() const noexcept { return poser_.stop(); }
  /// True if the base executes an evasion (safe/evasion.h) instead of the policy's task.
  bool evades() const noexcept { return asked().evades; }

 private:
  // Output of the stages from the policy on.
  struct Answer {
    VectorX command;
    Task task = {};
    FallbackSolver::Outcome outcome = {};
    Vector6 slack = Vector6::Zero();
    int active_rows = 0;
    double kept = 1.0;
    double manipulability = 0.0;
  };

  // Stages of a step, in order.
  bool usable(const Observation& observation) const noexcept;
  void brake(const Observation& observation, StepResult& result) noexcept;
  void solve(const Posed& posed, StepResult& result) noexcept;
  Posed guard(const Posed& posed, const Situation& now, StepResult& result) noexcept;
  void scale_output(const Posed& posed) noexcept;
  void send(VectorX& command) noexcept;

  int count_active(const Posed& posed) const noexcept;
  void begin(StepResult& result) noexcept;
  void report(const Situation* now, StepResult& result) noexcept;

  std::shared_ptr<RobotModel> own_;  // the model with its spare shape; null if that belongs to another controller
  std::shared_ptr<const RobotModel> model_;
  ControllerParams params_;
  double control_period_;
  bool timing_ = false;
  StepClock* clock_ = nullptr;

  // Memory between steps.
  SeenMap map_;
  std::vector<ObjectShape> told_;  // the objects that observations have
  Predictor predictor_;
  Escape escape_;
  std::unique_ptr<Lookahead> lookahead_;  // null if `plan` is off

  // Stages: each reads const inputs and writes its own buffers.
  Assessment assessment_;
  QpPoser poser_;
  std::unique_ptr<Policy> policy_;
  FallbackSolver fallback_;
  std::vector<std::unique_ptr<Guard>> guards_;

  // The last step, for inspection.
  Answer answer_;
  std::vector<std::string> object_names_;
};

}  // namespace moma
