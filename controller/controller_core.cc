#include "controller/controller_core.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "controller/lookahead/lookahead.h"
#include "controller/model/base_kind.h"

namespace moma {
namespace {

ControllerParams checked(ControllerParams params, const RobotModel& model, double control_period) {
  ControllerParams full = resolved(std::move(params), model);
  std::string errors;
  for (const ParamsIssue& issue : check_params(full, model, control_period))
    if (!issue.warning) errors += (errors.empty() ? "" : "; ") + issue.key + " " + issue.message;
  if (!errors.empty()) throw std::invalid_argument("controller parameters: " + errors);
  return full;
}

// Null if the model has a spare shape already.
std::shared_ptr<RobotModel> with_room(const std::shared_ptr<const RobotModel>& model) {
  if (model == nullptr) throw std::invalid_argument("a controller needs a robot");
  return model->spare ? nullptr : with_spare_shape(*model);
}

bool finite(const GoalState& goal) noexcept {
  return goal.X_WG.matrix().allFinite() && goal.V_WG_W.allFinite() && goal.free.allFinite();
}

bool finite(const std::optional<ObjectCovariance>& covariance) noexcept {
  return !covariance || (covariance->position_W.allFinite() && covariance->velocity_W.allFinite());
}

}  // namespace

ControllerCore::ControllerCore(std::shared_ptr<const RobotModel> model, ControllerParams params, double control_period,
                               SolverMaker make_qp_solver)
    : own_(with_room(model)),
      model_(own_ ? own_ : model),
      params_(checked(std::move(params), *model_, control_period)),
      control_period_(control_period),
      map_(model, params_.map, params_.prediction.base_sensing, params_.prediction.joint_sensing),
      predictor_(*model_, params_.prediction, params_.uncertainty, params_.base_share, control_period,
                 params_.acceleration_limit),
      escape_(params_.escape, params_.servo, *model_, control_period),
      lookahead_(params_.plan.enabled && params_.method == Method::kQp
                     ? std::make_unique<Lookahead>(model_, params_, control_period)
                     : nullptr),
      assessment_(model_, params_),
      poser_(model_, params_, control_period),
      policy_(make_policy({model_, params_, poser_, escape_, lookahead_.get()})),
      fallback_(make_qp_solver, params_.collision.relaxation),
      guards_(make_guards(model_, params_, control_period)) {
  answer_.command = VectorX::Zero(model_->num_velocities());
  reset({});
}

ControllerCore::~ControllerCore() = default;

void ControllerCore::reset(std::span<const ObjectShape> told) {
  std::vector<ObjectShape> objects(told.begin(), told.end());
  map_.reset();
  map_.append_shapes(objects);
  told_.assign(told.begin(), told.end());
  if (own_) carry(*own_, {}, nullptr);
  object_names_.clear();
  for (const ObjectShape& object : objects) object_names_.push_back(object.name);
  poser_.set_objects(objects);
  assessment_.allocate(objects.size());
  fallback_.allocate(poser_.problem().n(), poser_.problem().capacity());
  escape_.reset();
  if (predictor_.on()) predictor_.reset(told, map_.count());
  for (const std::unique_ptr<Guard>& guard : guards_) guard->set_objects(objects);
  if (lookahead_) lookahead_->reset(objects);
  answer_ = {.command = VectorX::Zero(model_->num_velocities())};
}

void ControllerCore::prepare(StepResult& result) const { result.command = VectorX::Zero(model_->num_velocities()); }

// One step: sense, predict, assess, decide, pose, solve, guard, scale, send. Each stage reads the results of earlier
// stages, and does not change them.
void ControllerCore::step(const Observation& observation, StepResult& result) noexcept {
  begin(result);
  if (!usable(observation) || result.command.size() != answer_.command.size()) return brake(observation, result);
  if (own_) {
    const std::optional<Carried>& carried = observation.carried;
    carry(*own_, carried, carried ? &told_[static_cast<std::size_t>(carried->object)].shape : nullptr);
  }
  if (map_.on()) {
    map_.observe(observation);
    std::ranges::copy(map_.states(), predictor_.more().begin());
    if (map_.waits()) return brake(observation, result);
  }
  const Observation& seen = predictor_.on() ? predictor_.predict(observation) : observation;
  const Situation now = assessment_.assess(seen, predictor_.spreads(),
                                           {predictor_.hold(), predictor_.missed(), predictor_.drive()}, clock_);
  const Demand demand = policy_->decide(now);
  if (const auto* direct = std::get_if<DirectCommand>(&demand)) {
    answer_.task = now.servo;
    answer_.command = direct->velocities;
    answer_.outcome.status = direct->status;
    if (direct->status != StepStatus::kSolved) answer_.outcome.fallback = Fallback::kBrake;
  } else {
    const Posed posed = poser_.pose(std::get<QpTask>(demand), now);
    solve(posed, result);
    scale_output(guard(posed, now, result));
  }
  enter(clock_, StepPart::kRest);
  send(result.command);
  report(&now, result);
  policy_->finish(now);
}

// Records the memory at the start of the step, and clears the answer.
void ControllerCore::begin(StepResult& result) noexcept {
  result.solve_seconds = 0.0;
  result.least_distance = kInfinity;
  result.escape = escape_.state();
  result.plan = lookahead_ ? lookahead_->state().brief : PlanBrief{};
  poser_.clear();
  answer_.task = Task{};
  answer_.outcome = {};
  answer_.slack.setZero();
  answer_.active_rows = 0;
  answer_.kept = 1.0;
}

bool ControllerCore::usable(const Observation& o) const noexcept {
  if (o.q.size() != model_->num_joints() || o.qdot.size() != model_->num_velocities() ||
      o.objects.size() != told_.size())
    return false;
  if (!std::isfinite(o.time) || !o.base.allFinite() || !o.q.allFinite() || !o.qdot.allFinite() || !finite(o.goal) ||
      (o.next && !finite(*o.next)) || (o.upright && !(o.upright->axis.allFinite() && std::isfinite(o.upright->angle))))
    return false;
  const auto count = static_cast<int>(told_.size());
  if (o.carried &&
      (o.carried->object < 0 || o.carried->object >= count || o.carried->support >= count || !is_pose(o.carried->X_EO)))
    return false;
  for (const ObjectState& object : o.objects)
    if (object.visible &&
        (!object.X_WO.matrix().allFinite() || !object.V_WO_W.allFinite() || !finite(object.covariance)))
      return false;
  return true;
}

// Answers an unusable observation. A result of a wrong size is filled as far as possible.
void ControllerCore::brake(const Observation& o, StepResult& result) noexcept {
  if (predictor_.on()) predictor_.skip();
  poser_.brake(o.q, predictor_.on() ? predictor_.velocity() : o.qdot, answer_.command);
  if (result.command.size() == answer_.command.size()) {
    send(result.command);
  } else {
    for (Eigen::Index i = 0; i < result.command.size(); ++i)
      result.command[i] = i < answer_.command.size() ? answer_.command[i] : 0.0;
    if (predictor_.on()) predictor_.send(answer_.command, answer_.command);
  }
  answer_.outcome.status = StepStatus::kInvalidInput;
  answer_.outcome.fallback = Fallback::kBrake;
  report(nullptr, result);
}

void ControllerCore::solve(const Posed& posed, StepResult& result) noexcept {
  enter(clock_, StepPart::kSolve);
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = timing_ ? Clock::now() : Clock::time_point{};
  answer_.outcome = fallback_.solve(posed.problem, posed.bounds.hard_lower, posed.bounds.hard_upper,
                                    poser_.limits().has_soft_acceleration(), posed.bounds.pair);
  if (timing_) result.solve_seconds += std::chrono::duration<double>(Clock::now() - start).count();
  enter(clock_, StepPart::kRest);
  const VectorX& x = fallback_.solution().x;
  answer_.task = posed.asked.task;
  answer_.command = x.head(model_->num_velocities());
  if (params_.slack.enabled) answer_.slack = x.segment<6>(model_->num_velocities());
  answer_.active_rows = answer_.outcome.fallback == Fallback::kBrake ? 0 : count_active(posed);
  for (const ProximityPair& pair : posed.near.pairs) {
    if (pair.kind != PairKind::kObject) continue;
    result.least_distance = pair.distance.d;
    break;
  }
}

// Returns the problem whose solution is the command: a guard may pose another one.
Posed ControllerCore::guard(const Posed& posed, const Situation& now, StepResult& result) noexcept {
  for (const std::unique_ptr<Guard>& guard : guards_) {
    enter(clock_, StepPart::kSafety);
    const Verdict verdict = guard->judge(now, posed, answer_.command);
    if (const auto* slowed = std::get_if<Slowed>(&verdict)) {
      answer_.command = slowed->command;
      answer_.kept = slowed->kept;
      break;
    }
    if (const auto* asked = std::get_if<QpTask>(&verdict)) {
      const Posed other = poser_.pose(*asked, now);
      solve(other, result);
      answer_.kept = 0.0;
      return other;
    }
  }
  return posed;
}

// qdot *= far/e or near (OutputScalingParams), clipped into the solution's bounds.
void ControllerCore::scale_output(const Posed& posed) noexcept {
  const OutputScalingParams& s = params_.output_scaling;
  if (!s.enabled || answer_.outcome.fallback == Fallback::kBrake) return;
  const double e = answer_.task.raw_error_norm;
  answer_.command *= e > s.switch_distance ? s.far / e : s.near;
  const bool hard = answer_.outcome.beyond_acceleration();
  const VectorX& lower = hard ? posed.bounds.hard_lower : posed.bounds.lower;
  const VectorX& upper = hard ? posed.bounds.hard_upper : posed.bounds.upper;
  for (Eigen::Index i = 0; i < answer_.command.size(); ++i)
    answer_.command[i] = std::min(std::max(answer_.command[i], lower[i]), upper[i]);
}

// Writes the command to send now. With prediction the part of the base or of the joints may wait.
void ControllerCore::send(VectorX& command) noexcept {
  if (predictor_.on()) {
    predictor_.send(answer_.command, command);
  } else {
    command = answer_.command;
  }
}

// Writes the answer; `now` is null if the observation was unusable.
void ControllerCore::report(const Situation* now, StepResult& result) noexcept {
  const bool finite = now != nullptr && std::isfinite(now->servo.error_norm) && now->servo.error.allFinite() &&
                      std::isfinite(now->manipulability);
  result.error = finite ? now->servo.error : Vector6(Vector6::Zero());
  result.error_norm = finite ? now->servo.error_norm : params_.error_norm.max;
  result.manipulability = finite ? now->manipulability : 0.0;
  if (now != nullptr) answer_.manipulability = now->manipulability;
  result.slack = answer_.slack;
  result.status = answer_.outcome.status;
  result.fallback = answer_.outcome.fallback;
  result.iterations = answer_.outcome.iterations;
  result.rows = poser_.problem().rows;
  result.active_rows = answer_.active_rows;
  result.kept = answer_.kept;
  const bool identifies = predictor_.identifies();
  result.latency_base = identifies && model_->base_dof() > 0 ? predictor_.base_round_trip() : -1.0;
  result.latency_joints = identifies ? predictor_.joint_round_trip() : -1.0;
}

int ControllerCore::count_active(const Posed& posed) const noexcept {
  const QpProblem& problem = posed.problem;
  const VectorX& x = fallback_.solution().x;
  const bool hard = answer_.outcome.beyond_acceleration();
  int active = 0;
  for (int i = 0; i < problem.n(); ++i) {
    const bool loose = hard && i < posed.bounds.hard_lower.size();
    const double low = loose ? posed.bounds.hard_lower[i] : problem.lb[i];
    const double high = loose ? posed.bounds.hard_upper[i] : problem.ub[i];
    if (x[i] - low < kHeld || high - x[i] < kHeld) ++active;
  }
  for (int r = 0; r < problem.rows; ++r) {
    double value = 0.0;
    for (int i = 0; i < problem.n(); ++i) value += problem.A(r, i) * x[i];
    value -= fallback_.given(r);
    if (value - problem.lbA[r] < kHeld || problem.ubA[r] - value < kHeld) ++active;
  }
  return active;
}

void ControllerCore::get_memory(ControllerMemory& memory) const {
  memory.escape = escape_.memory();
  if (predictor_.on()) memory.prediction = predictor_.memory();
  if (lookahead_) memory.plan = lookahead_->state();
  memory.map = map_.boxes();
}

void ControllerCore::set_memory(const ControllerMemory& memory) noexcept {
  escape_.set_memory(memory.escape);
  if (predictor_.on()) predictor_.set_memory(memory.prediction);
  if (lookahead_) lookahead_->set_state(memory.plan);
  if (map_.on()) map_.set_boxes(memory.map);
}

std::string ControllerCore::row_name(int row) const {
  return moma::row_name(problem().ids.at(static_cast<std::size_t>(row)), *model_, object_names_);
}

double ControllerCore::kkt_residual() const {
  if (params_.method != Method::kQp || outcome().fallback == Fallback::kBrake) return kInfinity;
  const QpSolution& s = solution();
  return moma::kkt_residual(final_problem(), s.x, s.bound_multipliers, s.row_multipliers);
}

VectorX ControllerCore::wheels() const {
  Eigen::Vector4d speeds;
  const int count = wheel_speeds(model_->base, answer_.command, speeds);
  return speeds.head(count);
}

}  // namespace moma
