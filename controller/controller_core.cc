#include "controller/controller_core.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "controller/ahead/lookahead.h"
#include "controller/model/base_kind.h"
#include "controller/qp/terms.h"
#include "controller/qp/tracking.h"
#include "controller/safe/evasion.h"
#include "controller/task/separate.h"

namespace moma {
namespace {

// A value this near to its limit is counted as active [m/s, rad/s].
constexpr double kActive = 1e-8;

ControllerParams checked(ControllerParams params, const RobotModel& model, double control_period) {
  ControllerParams full = resolved(std::move(params), model);
  std::string errors;
  for (const ParamsIssue& issue : check_params(full, model, control_period))
    if (!issue.warning) errors += (errors.empty() ? "" : "; ") + issue.key + " " + issue.message;
  if (!errors.empty()) throw std::invalid_argument("controller parameters: " + errors);
  return full;
}

std::shared_ptr<const RobotModel> not_null(std::shared_ptr<const RobotModel> model) {
  if (model == nullptr) throw std::invalid_argument("a controller needs a robot");
  return model;
}

bool finite(const std::optional<ObjectCovariance>& covariance) noexcept {
  return !covariance || (covariance->position_W.allFinite() && covariance->velocity_W.allFinite());
}

}  // namespace

ControllerCore::ControllerCore(std::shared_ptr<const RobotModel> model, ControllerParams params, double control_period)
    : model_(not_null(std::move(model))),
      params_(checked(std::move(params), *model_, control_period)),
      control_period_(control_period),
      base_dof_(model_->base_dof()),
      nv_(model_->num_velocities()),
      kinematics_(model_),
      proximity_(model_),
      collision_(*model_, params_.collision, {*model_, params_.acceleration_limit, params_.base_share > 0.0},
                 {params_.uncertainty, base_dof_}),
      passing_(*model_, params_.collision),
      separation_(*model_, params_.collision, {*model_, params_.acceleration_limit, params_.base_share > 0.0},
                  {params_.uncertainty, base_dof_}),
      predictor_(*model_, params_.prediction, params_.uncertainty, params_.base_share, control_period,
                 params_.acceleration_limit),
      check_(model_, params_.collision.check, params_.acceleration_limit, params_.base_share > 0.0, control_period,
             {params_.uncertainty, base_dof_}, own_margins(params_.collision.floor, params_.collision.self)),
      escape_(params_.escape, params_.servo, *model_, control_period),
      bounds_(*model_, params_, control_period),
      fallback_(params_.solver, params_.collision.relaxation),
      detour_posture_{params_.escape.posture_weight, params_.escape.posture_gain, true, model_->ready},
      prismatic_(model_->num_joints()),
      J_m_(VectorX::Zero(model_->num_joints())),
      hard_lower_(VectorX::Zero(nv_)),
      hard_upper_(VectorX::Zero(nv_)),
      command_(VectorX::Zero(nv_)),
      gradient_(VectorX::Zero(nv_)),
      scratch_(VectorX::Zero(nv_)) {
  for (int i = 0; i < model_->num_joints(); ++i)
    prismatic_[i] = model_->joints[static_cast<std::size_t>(i)].type == JointType::kPrismatic ? 1 : 0;
  if (params_.collision.evasion.enabled)
    evasion_ = std::make_unique<Evasion>(model_, params_.collision.evasion, params_.acceleration_limit,
                                         params_.base_share, control_period_);
  if (params_.plan.enabled && params_.method == Method::kQp)
    lookahead_ = std::make_unique<Lookahead>(model_, params_, control_period_);
  reset({});
}

ControllerCore::~ControllerCore() = default;

void ControllerCore::reset(std::span<const ObjectShape> objects) {
  proximity_.set_objects(objects);
  object_names_.clear();
  for (const ObjectShape& object : objects) object_names_.push_back(object.name);
  const int num_objects = static_cast<int>(objects.size());
  const int collision_rows =
      collision_.allocate(num_objects) + passing_.allocate(num_objects) + separation_.allocate(num_objects);
  const int variables = nv_ + (params_.slack.enabled ? 6 : 0);
  const int drive_rows = bounds_.linear_pair(command_).on ? 2 : 0;
  const int rows = 6 + collision_rows + num_wheels(model_->base) + drive_rows;
  problem_.allocate(variables, rows);
  if (params_.slack.enabled) {
    problem_.lb.tail<6>() = -params_.slack.limit;
    problem_.ub.tail<6>() = params_.slack.limit;
  }
  fallback_.allocate(variables, rows);
  escape_.allocate(num_objects);
  escape_.reset();
  if (predictor_.on()) predictor_.reset(num_objects);
  check_.set_objects(objects);
  if (evasion_) evasion_->set_objects(objects);
  if (lookahead_) lookahead_->reset(objects);
  task_ = Task{};
  outcome_ = {};
  evades_ = false;
  counters_ = {};
  manipulability_ = 0.0;
  J_m_.setZero();
  command_.setZero();
}

void ControllerCore::prepare(StepResult& result) const { result.command = VectorX::Zero(nv_); }

bool ControllerCore::valid(const Observation& o) const noexcept {
  if (o.q.size() != model_->num_joints() || o.qdot.size() != nv_ || o.objects.size() != object_names_.size())
    return false;
  if (!std::isfinite(o.time) || !o.base.allFinite() || !o.q.allFinite() || !o.qdot.allFinite() ||
      !o.goal.X_WG.matrix().allFinite() || !o.goal.V_WG_W.allFinite())
    return false;
  for (const ObjectState& object : o.objects)
    if (object.visible &&
        (!object.X_WO.matrix().allFinite() || !object.V_WO_W.allFinite() || !finite(object.covariance)))
      return false;
  return true;
}

void ControllerCore::step(const Observation& observation, StepResult& result) noexcept {
  result.solve_seconds = 0.0;
  result.iterations = 0;
  result.slack.setZero();
  result.least_distance = kInfinity;
  result.escape = escape_.state();
  result.kept = 1.0;
  result.plan = !lookahead_ ? PlanBrief{} : lookahead_->state().brief;
  problem_.clear();
  outcome_ = {};
  evades_ = false;
  if (!valid(observation) || result.command.size() != nv_) {
    brake(observation, result);
    return;
  }
  const Observation& seen = predictor_.on() ? predictor_.predict(observation) : observation;
  enter(clock_, StepPart::kKinematics);
  observe(seen);
  if (params_.method != Method::kQp)
    solve_closed_form(seen, result);
  else if (!drive_base(seen, result))
    solve_qp(seen, result);
  enter(clock_, StepPart::kRest);
  send(result);
  result.error = task_.error;
  result.error_norm = task_.error_norm;
  result.manipulability = manipulability_;
  result.status = outcome_.status;
  result.fallback = outcome_.fallback;
  result.iterations = outcome_.iterations;
  result.rows = problem_.rows;
  if (!std::isfinite(result.error_norm) || !result.error.allFinite() || !std::isfinite(manipulability_)) {
    result.error.setZero();
    result.error_norm = params_.error_norm.max;
    result.manipulability = 0.0;
  }
  counters_.count(outcome_.status, outcome_.fallback, collision_.left_out());
  if (!lookahead_) return;
  enter(clock_, StepPart::kAhead);
  lookahead_->work(seen, begun_with_);
}

// Remembers the command, and hands on what is to be sent now: of a predictor, that of base or joints may wait.
void ControllerCore::send(StepResult& result) noexcept {
  if (predictor_.on()) {
    predictor_.send(command_, result.command);
  } else {
    result.command = command_;
  }
  result.latency_base = predictor_.identifies() && base_dof_ > 0 ? predictor_.base_round_trip() : -1.0;
  result.latency_joints = predictor_.identifies() ? predictor_.joint_round_trip() : -1.0;
}

void ControllerCore::get_memory(ControllerMemory& memory) const {
  memory.escape = escape_.memory();
  if (predictor_.on()) memory.prediction = predictor_.memory();
  if (lookahead_) memory.plan = lookahead_->state();
}

void ControllerCore::set_memory(const ControllerMemory& memory) noexcept {
  escape_.set_memory(memory.escape);
  if (predictor_.on()) predictor_.set_memory(memory.prediction);
  if (lookahead_) lookahead_->set_state(memory.plan);
}

// Each velocity by itself: what is known of the state still bounds what is done about it.
void ControllerCore::brake(const Observation& o, StepResult& result) noexcept {
  if (predictor_.on()) predictor_.skip();
  const VectorX& qdot = predictor_.on() ? predictor_.velocity() : o.qdot;
  hard_lower_ = -bounds_.speed();
  hard_upper_ = bounds_.speed();
  if (o.q.size() == model_->num_joints()) bounds_.joint_limits(o.q, hard_lower_, hard_upper_);
  problem_.lb.head(nv_) = hard_lower_;
  problem_.ub.head(nv_) = hard_upper_;
  if (qdot.size() == nv_)
    bounds_.acceleration(qdot, hard_lower_, hard_upper_, problem_.lb.head(nv_), problem_.ub.head(nv_));
  for (int i = 0; i < nv_; ++i) {
    const bool known = qdot.size() == nv_ && std::isfinite(qdot[i]);
    const double low = known ? problem_.lb[i] : hard_lower_[i];
    const double high = known ? problem_.ub[i] : hard_upper_[i];
    command_[i] = braking(low, high);
  }
  pair_ = qdot.size() == nv_ && qdot.allFinite() ? bounds_.linear_pair(qdot) : LinearPair{};
  if (pair_.on) smallest_command(problem_.lb.head(2), problem_.ub.head(2), pair_, command_.head(2));
  if (result.command.size() == nv_) {
    send(result);
  } else {
    if (predictor_.on()) predictor_.send(command_, scratch_);
    for (Eigen::Index i = 0; i < result.command.size(); ++i) result.command[i] = i < nv_ ? command_[i] : 0.0;
  }
  outcome_.status = StepStatus::kInvalidInput;
  outcome_.fallback = Fallback::kBrake;
  result.status = outcome_.status;
  result.fallback = outcome_.fallback;
  result.error.setZero();
  result.error_norm = params_.error_norm.max;
  result.manipulability = 0.0;
  result.rows = 0;
  result.active_rows = 0;
  task_ = Task{};
  counters_.count(outcome_.status, outcome_.fallback, 0);
}

void ControllerCore::observe(const Observation& o) noexcept {
  kinematics_.update(o.base, o.q);
  task_ = Task{};
  task_.error = pose_error(kinematics_.X_WE(), o.goal.X_WG);
  const Vector6 error =
      params_.servo.error == ServoError::kRpy ? pose_error_rpy(kinematics_.X_WE(), o.goal.X_WG) : task_.error;
  task_.nu = servo_twist(params_.servo, error, o.goal.V_WG_W);
  task_.raw_error_norm = error_norm(params_.error_norm, task_.error);
  task_.error_norm = std::min(std::max(task_.raw_error_norm, params_.error_norm.min), params_.error_norm.max);
  task_.theta_eps = base_dof_ > 0 ? bearing(kinematics_.X_WB(), kinematics_.X_WE().translation()) : 0.0;
  const auto J_arm = kinematics_.J_WE_W().rightCols(model_->num_joints());
  if (params_.manipulability.weight != 0.0) {
    manipulability_ = manipulability_gradient(J_arm, prismatic_, params_.manipulability.rows, J_m_).value;
  } else {
    manipulability_ = moma::manipulability(J_arm, params_.manipulability.rows);
    J_m_.setZero();
  }
  bounds_.joint_limits(o.q, hard_lower_, hard_upper_);
}

void ControllerCore::build(const Observation& o) noexcept {
  enter(clock_, StepPart::kRows);
  bound_acceleration(o.qdot);
  if (params_.separate.enabled) hold_base();
  enter(clock_, StepPart::kDistances);
  collision_.select(proximity_.query(kinematics_, o.objects, collision_.ranges()));
  passing_.select(kinematics_, proximity_, o.objects);
  look_ahead(o);
  enter(clock_, StepPart::kRows);
  if (lookahead_ && lookahead_->guides()) {
    ask_for(lookahead_->velocities(), o);
  } else {
    escape_.update({kinematics_, o.goal, collision_.sorted(), o.objects, passing_.near(), &proximity_}, task_);
    add_base_term(params_, base_dof_, task_, problem_);
    add_manipulability_term(params_.manipulability, base_dof_, J_m_, problem_);
  }
  add_terms(o);
  passing_.add(kinematics_, proximity_, o.objects, problem_);
  separation_.add(kinematics_, proximity_, o.objects, predictor_.spreads(), problem_);
  add_wheel_rows(model_->base, problem_);
  add_drive_rows(pair_, problem_);
}

void ControllerCore::add_terms(const Observation& o) noexcept {
  add_slack_term(params_.slack, nv_, task_, problem_);
  add_acceleration_term(params_.acceleration_weight, o.qdot, problem_);
  add_posture_term(params_.posture, base_dof_, params_.posture.target, o.q, problem_);
  if (task_.detour) add_posture_term(detour_posture_, base_dof_, detour_posture_.target, o.q, problem_);
  add_tracking_rows(kinematics_.J_WE_W(), task_.nu, params_.tracking_band, params_.slack.enabled, problem_);
  collision_.add(kinematics_, proximity_, o.objects, predictor_.spreads(), problem_);
}

void ControllerCore::bound_acceleration(const VectorX& qdot) noexcept {
  bounds_.acceleration(qdot, hard_lower_, hard_upper_, problem_.lb.head(nv_), problem_.ub.head(nv_));
  pair_ = bounds_.linear_pair(qdot);
  if (!bounds_.hard_base()) return;
  // What the drives can do holds in every stage of the fallback.
  hard_lower_.head(base_dof_) = problem_.lb.head(base_dof_);
  hard_upper_.head(base_dof_) = problem_.ub.head(base_dof_);
}

// The first part of motion in two parts: true while the base drives, with the arm at rest. Rows are not looked at.
bool ControllerCore::drive_base(const Observation& o, StepResult& result) noexcept {
  if (!params_.separate.enabled || base_dof_ == 0) return false;
  const BaseDrive drive = drive_into_reach(params_.separate, model_->base, o.base, o.goal.X_WG.translation());
  if (!drive.driving) return false;
  bound_acceleration(o.qdot);
  command_.setZero();
  kind_of(model_->base.type).set_coordinates(drive.velocity_B, command_);
  command_ = command_.cwiseMax(problem_.lb.head(nv_)).cwiseMin(problem_.ub.head(nv_));
  scale_into_limits(*model_, bounds_.speed(), command_);
  result.active_rows = 0;
  return true;
}

// The second part: the base stands, or comes to rest as fast as it may.
void ControllerCore::hold_base() noexcept {
  for (int i = 0; i < base_dof_; ++i) {
    const double rest = braking(problem_.lb[i], problem_.ub[i]);
    problem_.lb[i] = problem_.ub[i] = rest;
    hard_lower_[i] = hard_upper_[i] = rest;
  }
}

void ControllerCore::look_ahead(const Observation& o) noexcept {
  if (!lookahead_) return;
  enter(clock_, StepPart::kAhead);
  lookahead_->decide(o);
  if (lookahead_->begins_anew()) escape_.set_state(lookahead_->start());
  begun_with_ = escape_.state();
}

// The velocities of a path, or none: what keeps clear and inside limits stays as it is, and so do all bounds but those
// of the joints' limits, which a path keeps away from by itself.
void ControllerCore::ask_for(const VectorX& velocities, const Observation& o) noexcept {
  constexpr double kSlack = 1e-4;  // tracking gives way to the velocities
  lookahead_->bounds().joint_limits(o.q, hard_lower_, hard_upper_);
  bound_acceleration(o.qdot);
  task_.nu.setZero();
  const Matrix6X& J = kinematics_.J_WE_W();
  for (int i = 0; i < nv_; ++i) task_.nu += velocities[i] * J.col(i);
  task_.slack_scale.setConstant(kSlack);
  const double weight = params_.plan.weight;
  for (int i = 0; i < nv_; ++i) {
    problem_.H[i] += weight;
    problem_.g[i] -= weight * velocities[i];
  }
}

void ControllerCore::solve_qp(const Observation& o, StepResult& result) noexcept {
  build(o);
  for (const ProximityPair& pair : collision_.sorted()) {
    if (pair.kind != PairKind::kObject) continue;
    result.least_distance = pair.distance.d;
    break;
  }
  enter(clock_, StepPart::kSolve);
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = timing_ ? Clock::now() : Clock::time_point{};
  outcome_ = fallback_.solve(problem_, hard_lower_, hard_upper_, bounds_.has_acceleration(), pair_);
  if (timing_) result.solve_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  enter(clock_, StepPart::kRest);
  const VectorX& x = fallback_.solution().x;
  command_ = x.head(nv_);
  if (params_.slack.enabled) result.slack = x.segment<6>(nv_);
  result.active_rows = outcome_.fallback == Fallback::kBrake ? 0 : count_active();
  if (evasion_ || check_.on()) enter(clock_, StepPart::kSafety);
  if (evasion_ && !evasion_->passes(o, command_, scratch_)) {
    result.kept = 0.0;
    evade(o, result);
  } else if (check_.on()) {
    check_braking(o, result);
  }
  if (params_.output_scaling.enabled && outcome_.fallback != Fallback::kBrake) scale_output();
}

// The base does what leads out of the way (scratch_), and the arm goes with it, as far as its rows let it: what looks
// ahead of the base is decided.
void ControllerCore::evade(const Observation& o, StepResult& result) noexcept {
  constexpr double kSlack = 1e-4, kWeight = 1.0;  // E goes with the base; joints are asked for no velocity
  evades_ = true;
  problem_.clear();
  bound_acceleration(o.qdot);
  task_.nu.setZero();
  task_.detour = false;
  for (int i = 0; i < base_dof_; ++i) {
    const double u = std::min(std::max(scratch_[i], problem_.lb[i]), problem_.ub[i]);
    problem_.lb[i] = problem_.ub[i] = hard_lower_[i] = hard_upper_[i] = u;
    task_.nu += u * kinematics_.J_WE_W().col(i);
  }
  for (int i = base_dof_; i < nv_; ++i) problem_.H[i] += kWeight;
  task_.slack_scale.setConstant(kSlack);
  add_terms(o);
  outcome_ = fallback_.solve(problem_, hard_lower_, hard_upper_, bounds_.has_acceleration());
  command_ = fallback_.solution().x.head(nv_);
  if (params_.slack.enabled) result.slack = fallback_.solution().x.segment<6>(nv_);
  result.active_rows = outcome_.fallback == Fallback::kBrake ? 0 : count_active();
}

void ControllerCore::check_braking(const Observation& o, StepResult& result) noexcept {
  smallest_command(problem_.lb.head(nv_), problem_.ub.head(nv_), pair_, scratch_);
  result.kept = check_.apply(o, {hard_lower_, hard_upper_, scratch_}, predictor_.spreads(), command_,
                             {collision_.sorted(), collision_.ranges(), &kinematics_});
}

void ControllerCore::scale_output() noexcept {
  const OutputScalingParams& s = params_.output_scaling;
  const double e = task_.raw_error_norm;
  command_ *= e > s.switch_distance ? s.far / e : s.near;
  const bool hard = outcome_.beyond_acceleration();
  for (int i = 0; i < nv_; ++i) {
    const double low = hard ? hard_lower_[i] : problem_.lb[i];
    const double high = hard ? hard_upper_[i] : problem_.ub[i];
    command_[i] = std::min(std::max(command_[i], low), high);
  }
}

int ControllerCore::count_active() const noexcept {
  const VectorX& x = fallback_.solution().x;
  const bool hard = outcome_.beyond_acceleration();
  int active = 0;
  for (int i = 0; i < problem_.n(); ++i) {
    const double low = hard && i < nv_ ? hard_lower_[i] : problem_.lb[i];
    const double high = hard && i < nv_ ? hard_upper_[i] : problem_.ub[i];
    if (x[i] - low < kActive || high - x[i] < kActive) ++active;
  }
  for (int r = 0; r < problem_.rows; ++r) {
    double value = 0.0;
    for (int i = 0; i < problem_.n(); ++i) value += problem_.A(r, i) * x[i];
    value -= fallback_.given(r);
    if (value - problem_.lbA[r] < kActive || problem_.ubA[r] - value < kActive) ++active;
  }
  return active;
}

void ControllerCore::solve_closed_form(const Observation& o, StepResult& result) noexcept {
  enter(clock_, StepPart::kSolve);
  result.active_rows = 0;
  const Matrix6X& J = kinematics_.J_WE_W();
  if (!J.allFinite() || !task_.nu.allFinite() || !J_m_.allFinite()) {
    for (int i = 0; i < nv_; ++i) command_[i] = 0.0;
    outcome_.status = StepStatus::kInvalidInput;
    outcome_.fallback = Fallback::kBrake;
    return;
  }
  inverse_.update(J, params_.closed_form.damping);
  rrmc(inverse_, J, task_.nu, command_);
  if (params_.method != Method::kRrmc) {
    park_gradient(params_, base_dof_, J_m_, gradient_);
    if (params_.method == Method::kBaur) add_limit_repulsion(*model_, o.q, gradient_);
    add_projected(inverse_, J, gradient_, scratch_, command_);
  }
  if (!command_.allFinite()) {
    command_.setZero();
    outcome_.status = StepStatus::kInvalidInput;
    outcome_.fallback = Fallback::kBrake;
    return;
  }
  if (params_.closed_form.scaled) scale_into_limits(*model_, bounds_.speed(), command_);
}

VectorX ControllerCore::J_m() const {
  VectorX gradient(model_->num_joints());
  manipulability_gradient(kinematics_.J_WE_W().rightCols(model_->num_joints()), prismatic_, params_.manipulability.rows,
                          gradient);
  return gradient;
}

std::string ControllerCore::row_name(int row) const {
  return moma::row_name(problem_.ids.at(static_cast<std::size_t>(row)), *model_, object_names_);
}

const QpSolution& ControllerCore::solution() const { return fallback_.solution(); }

double ControllerCore::cost() const noexcept { return problem_.cost(fallback_.solution().x); }

double ControllerCore::kkt_residual() const {
  if (params_.method != Method::kQp || outcome_.fallback == Fallback::kBrake) return kInfinity;
  const QpSolution& s = fallback_.solution();
  return moma::kkt_residual(fallback_.final_problem(problem_), s.x, s.bound_multipliers, s.row_multipliers);
}

VectorX ControllerCore::wheels() const {
  Eigen::Vector4d speeds;
  const int count = wheel_speeds(model_->base, command_, speeds);
  return speeds.head(count);
}

}  // namespace moma
