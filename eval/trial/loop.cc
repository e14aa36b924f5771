#include "eval/trial/loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "controller/model/manipulability.h"
#include "world/draws.h"
#include "world/holding.h"
#include "world/scenario/time_bound.h"
#include "world/sensing/streams.h"

namespace moma {
namespace {

/// The rule for a goal: who passes through it does not dwell.
DwellRule rule_of(const TrialSpec& spec, const WorldGoal& goal) {
  SuccessRule rule = spec.success;
  if (!goal.stop) rule.dwell = 0.0;
  return {rule, spec.simulation.control_period};
}

// |x| + |y| + |z| + |roll| + |pitch| + |yaw| of X_EG.
double l1_error(const Isometry& X_WE, const Isometry& X_WG) {
  const Isometry X_EG = X_WE.inverse() * X_WG;
  return X_EG.translation().lpNorm<1>() + rpy_of(X_EG.linear()).lpNorm<1>();
}

}  // namespace

TrialLoop::TrialLoop(const TrialSpec& spec, const World& world, Plant& plant, Recording& recording,
                     ProfileClock* profile)
    : spec_(spec),
      world_(world),
      hand_(carries(world) ? with_spare_shape(*spec.robot->model) : nullptr),
      model_(hand_ ? *hand_ : *spec.robot->model),
      plant_(plant),
      r_(recording),
      profile_(profile),
      period_(spec.simulation.control_period),
      last_step_(std::max(1L, periods_in(spec.simulation.time_limit, period_))),
      kinematics_(hand_ ? hand_ : spec.robot->model),
      proximity_(hand_ ? hand_ : spec.robot->model),
      dwell_(rule_of(spec, world.goal)),
      stuck_(spec.stuck, any(spec.disturbances), period_),
      infeasible_(spec.infeasible, period_),
      separation_(spec),
      yielding_(world, period_),
      objects_(world.objects.size()),
      told_(object_shapes(world)) {
  take_goal();
  if (!world_.further.empty()) {
    r_.row.goals_reached = 0.0;
    r_.row.goals = "[]";
  }
  proximity_.set_objects(told_);
  object_states(world_, 0.0, objects_);
  objects_move_ =
      std::ranges::any_of(world_.objects, [](const WorldObject& object) { return !at_rest(object.motion, 0.0); });
  const Disturbances& disturbances = spec_.disturbances;
  if (senses_with_errors(disturbances)) {
    sensing_.emplace(disturbances, *spec.robot->model, world_, period_);
    for (ObjectShape& phantom : sensing_->phantoms(world_)) told_.push_back(std::move(phantom));
    if (disturbances.detection.seen_by == SeenBy::kDepth) told_.clear();
  }
  if (hand_ && told_.empty())
    throw std::runtime_error("the hand holds objects, which a controller has to be told (detection.seen_by)");
  if (acts_with_errors(disturbances)) actuation_.emplace(disturbances, model_, world_, period_);
  r_.control_period = period_;
  r_.success = spec.success;
  if (!goal_moves_ && world.further.empty() && is_whole(goal_)) {
    const double bound = world.time_bound ? *world.time_bound : time_bound(spec.robot->model, world).time;
    if (std::isfinite(bound)) r_.row.time_bound_s = bound;
  }
  if (spec_.simulation.mode == SimulationMode::kDynamic) {
    r_.row.energy_j = r_.row.redone_steps = r_.row.divided_steps = 0.0;
    if (model_.base_dof() > 0) r_.row.slip_max_m_s = 0.0;
  }
  const auto expected = static_cast<std::size_t>(std::min(last_step_, 4096L));
  r_.trace.reserve(expected);
  r_.states.reserve(expected + 1);
  r_.step_seconds.reserve(expected);
  if (world_.held) {
    kinematics_.update(world_.start.base, world_.start.q);
    hold(held_at_start(world_, kinematics_));
  }
  plant_.check_start(report_);
}

/// Makes goal number goal_index_ the present one.
void TrialLoop::take_goal() {
  const WorldGoal& goal = goal_of(world_, goal_index_);
  goal_ = goal_state(world_, time(k_), goal_index_);
  look_at_next();
  goal_moves_ = !at_rest(goal.motion, time(k_));
  r_.moving_goal = r_.moving_goal || goal_moves_;
  dwell_ = rule_of(spec_, goal);
}

void TrialLoop::look_at_next() {
  if (!is_last_goal())
    next_ = goal_state(world_, time(k_), goal_index_ + 1);
  else
    next_.reset();
}

/// Takes an object into the hand, or leaves it where it is.
void TrialLoop::hold(const std::optional<Carried>& carried) {
  if (carried_) objects_[static_cast<std::size_t>(carried_->object)].visible = true;
  carried_ = carried;
  if (carried_) objects_[static_cast<std::size_t>(carried_->object)].visible = false;
  carry(*hand_, carried_, carried_ ? &world_.objects[static_cast<std::size_t>(carried_->object)].shape : nullptr);
  plant_.carry(carried_);
}

/// Takes or leaves an object if the goal that was reached asks for it.
void TrialLoop::take_or_leave(const WorldGoal& goal) {
  if (!goal.take.empty()) {
    const int object = find_object(world_, goal.take);
    const Isometry& X_WO = objects_[static_cast<std::size_t>(object)].X_WO;
    hold(Carried{object, kinematics_.X_WE().inverse() * X_WO, support_of(world_, objects_, object)});
  } else if (!goal.leave.empty() && carried_) {
    left_.emplace_back(carried_->object, objects_[static_cast<std::size_t>(carried_->object)].X_WO);
    hold({});
  }
}

/// Moves the carried object with the hand, and the left ones to where they stand.
void TrialLoop::move_carried() {
  for (const auto& [object, X_WO] : left_) objects_[static_cast<std::size_t>(object)].X_WO = X_WO;
  if (!carried_) return;
  const auto at = static_cast<std::size_t>(carried_->object);
  objects_[at].X_WO = kinematics_.X_WE() * carried_->X_EO;
  if (carried_->support == kNoSupport) return;
  if (gap_between(world_, objects_, carried_->object, carried_->support) <= kLifted) return;
  carried_->support = kNoSupport;
  hold(Carried(*carried_));
}

/// Notes the present goal of several, and goes on to the next one.
void TrialLoop::goal_reached() {
  if (world_.further.empty()) return;
  TrialRow& row = r_.row;
  row.goals_reached += 1.0;
  const double clearance = clearance_.to_objects();
  row.goals.pop_back();
  row.goals += fmt::format(R"({}{{"time_s":{},"clearance_m":{}}}])", row.goals.size() > 1 ? "," : "",
                           time(dwell_.first()), std::isnan(clearance) ? "null" : fmt::format("{}", clearance));
  if (is_last_goal()) return;
  if (hand_) take_or_leave(goal_of(world_, goal_index_));
  ++goal_index_;
  clearance_ = {};
  take_goal();
}

/// The only way of information to a controller; world/sensing/sensing.h then disturbs it. Keeps sizes of `out` that
/// fit, so that only the first step allocates.
void TrialLoop::truth(Observation& out) const {
  const PlantState& truth = plant_.state();
  out.time = time(k_);
  out.base = truth.base;
  out.q = truth.q;
  out.qdot = truth.qdot;
  out.goal = goal_;
  out.next = next_;
  out.upright = world_.upright;
  out.carried = carried_;
  out.objects = objects_;
}

bool TrialLoop::sense() {
  while (true) {
    enter(profile_, TrialPart::kMetrics);
    take_report();
    finite_ = measure_state();
    if (finite_) compare_detectors();
    if (ends()) return false;
    enter(profile_, TrialPart::kSensing);
    look();
    if (!misses_period()) return true;
    apply_answer();
  }
}

void TrialLoop::look() {
  truth(observation_);
  if (sensing_) sensing_->sense(k_, observation_);
}

void TrialLoop::show(StepController& controller) {
  if (sensing_) sensing_->show(controller);
}

void TrialLoop::look_last() {
  if (finite_) look();
}

void TrialLoop::act(double seconds) {
  r_.step_seconds.push_back(seconds);
  if (result_.solve_seconds > 0.0) r_.solve_seconds.push_back(result_.solve_seconds);
  apply_answer();
}

TrialRow TrialLoop::finish() {
  r_.row.separation_margin_min_m = separation_.least();
  note_latencies();
  TrialRow row = measure(r_, model_);
  row.outcome = outcome_;
  row.reason = std::move(reason_);
  row.time_end_s = time(k_);
  if (row.outcome == Outcome::kSuccess) {
    row.time_to_goal_s = time(dwell_.first());
    row.times_bound = row.time_to_goal_s / row.time_bound_s;
  }
  if (row.outcome == Outcome::kCollision) describe_contacts(row);
  return row;
}

bool TrialLoop::misses_period() const {
  const double missed = spec_.disturbances.control.missed;
  if (k_ == 0 || !(missed > 0.0)) return false;
  const DisturbanceStreams streams(world_, spec_.disturbances.seed);
  return streams.sensing(DisturbanceSource::kMissedTick, k_).uniform() < missed;
}

/// Lets the plant follow the last answer for a period, and records a sample.
void TrialLoop::apply_answer() {
  enter(profile_, TrialPart::kMetrics);
  if (result_.command.size() != model_.num_velocities() || !result_.command.allFinite()) {
    throw std::runtime_error(fmt::format("the controller's command at t = {:.4g} s is not {} finite numbers", time(k_),
                                         model_.num_velocities()));
  }
  Sample& sample = r_.trace.emplace_back();
  sample.t = time(k_);
  const PlantState& state = plant_.state();
  sample.base = state.base;
  sample.q = state.q;
  sample.qdot = state.qdot;
  sample.command = result_.command;
  sample.error = error_;
  sample.slack = result_.slack;
  sample.manipulability = r_.states.back().manipulability;
  sample.least_distance = result_.least_distance;
  sample.status = result_.status;
  sample.fallback = result_.fallback;
  sample.active_rows = result_.active_rows;
  sample.escape = result_.escape;
  sample.plan = result_.plan;
  sample.object_time = yielding_.times(time(k_));
  infeasible_.count(result_.fallback);
  enter(profile_, TrialPart::kSensing);
  const VectorX& command = actuation_ ? actuation_->act(k_, result_.command) : result_.command;
  enter(profile_, TrialPart::kPlant);
  if (yielding_.any()) {
    yielding_.decide(time(k_), kinematics_, proximity_, objects_);
    plant_.set_paces(yielding_.paces());
  }
  plant_.advance(command, period_, report_);
  ++k_;
}

/// Adds the last period's report to the row. Of another mode's quantities, which are NaN, nothing changes.
void TrialLoop::take_report() {
  TrialRow& row = r_.row;
  row.energy_j += report_.energy;
  row.redone_steps += report_.redone_steps;
  row.divided_steps += report_.divided_steps;
  row.lcp_messages += report_.lcp_messages;
  if (report_.slip_max > row.slip_max_m_s) row.slip_max_m_s = report_.slip_max;
}

/// Compares the detectors at steps drawn from the world's own stream, and in every state that ends a trial by a
/// contact.
void TrialLoop::compare_detectors() {
  const double rate = spec_.simulation.cross_check;
  if (!(rate > 0.0)) return;
  Draws draws(world_.seed, world_.index, Stream::kCrossCheck, static_cast<std::uint64_t>(k_));
  if (draws.uniform() >= rate && report_.contacts.empty()) return;
  const DetectorCheck found = plant_.cross_check();
  TrialRow& row = r_.row;
  ++row.detector_checks;
  if (found.disagreements == 0) return;
  row.detector_disagreements += found.disagreements;
  row.detector_deepest_m = std::fmax(row.detector_deepest_m, found.deepest);
}

/// Measures errors, distances and all other quantities of the state. False if the state is not finite.
bool TrialLoop::measure_state() {
  const PlantState& state = plant_.state();
  if (!state.base.allFinite() || !state.q.allFinite() || !state.qdot.allFinite()) return false;
  if (objects_move_ && k_ > 0) object_states(world_, time(k_), objects_, yielding_.paces());
  if (goal_moves_ && k_ > 0) goal_ = goal_state(world_, time(k_), goal_index_);
  if (next_ && k_ > 0) look_at_next();
  kinematics_.update(state.base, state.q);
  if (hand_) move_carried();
  const Isometry& X_WE = kinematics_.X_WE();
  const Isometry X_WG = nearest_pose(goal_.X_WG, goal_.free, X_WE);
  error_ = pose_error(X_WE, X_WG);

  r_.last = state;
  StateRecord& record = r_.states.emplace_back();
  record.p_WE = X_WE.translation();
  record.orientation_error = error_.head<3>().norm();
  record.position_error = error_.tail<3>().norm();
  if (std::isfinite(spec_.success.l1)) record.l1_error = l1_error(X_WE, X_WG);
  const auto J_arm = kinematics_.J_WE_W().rightCols(model_.num_joints());
  record.manipulability = manipulability(J_arm, ManipulabilityRows::kTranslation);
  record.manipulability_all = manipulability(J_arm, ManipulabilityRows::kAll);
  if (world_.upright) {
    tilt_ = tilt(*world_.upright, X_WE.linear());
    r_.row.tilt_max_rad = std::fmax(r_.row.tilt_max_rad, tilt_);
  }
  clearance_.look(kinematics_, proximity_, objects_);
  r_.row.clearance_min_m = std::fmin(r_.row.clearance_min_m, clearance_.to_objects());
  r_.row.clearance_self_min_m = std::fmin(r_.row.clearance_self_min_m, clearance_.to_itself());
  if (objects_move_) separation_.look(kinematics_, proximity_, objects_, state.qdot);
  return true;
}

bool TrialLoop::end(Outcome outcome, std::string reason) {
  outcome_ = outcome;
  reason_ = std::move(reason);
  return true;
}

/// Applies the rules in their order. True if the trial has ended.
bool TrialLoop::ends() {
  if (!report_.contacts.empty()) return end(Outcome::kCollision);
  if (!finite_) return end(Outcome::kDiverged, report_.reason.empty() ? "the state is not finite" : report_.reason);
  if (world_.upright && tilt_ > world_.upright->angle)
    return end(Outcome::kSpilled, fmt::format("the tool is tilted by {:.3g} rad, beyond {:.3g} rad; {}", tilt_,
                                              world_.upright->angle, situation()));
  const StateRecord& now = r_.states.back();
  if (dwell_.update(k_, now.position_error, now.orientation_error, now.l1_error)) {
    const bool last = is_last_goal();
    goal_reached();
    if (last) return end(Outcome::kSuccess);
  }
  if (report_.diverged) return end(Outcome::kDiverged, report_.reason);
  if (report_.tipped) return end(Outcome::kTipped, report_.reason);
  if (spec_.simulation.joint_limits != AtJointLimit::kIgnore)
    if (std::string over = joint_over_limit(); !over.empty()) return end(Outcome::kJointLimit, std::move(over));
  if (infeasible_.reached())
    return end(Outcome::kInfeasible, fmt::format("no solved QP for {} s; {}", spec_.infeasible.time, situation()));
  if (stuck_.update(k_, plant_.state(), [&] { return all_at_rest(); }) && !dwell_.inside())
    return end(Outcome::kStuck, fmt::format("nothing moved for {} s; {}", stuck_.time(), situation()));
  if (k_ >= last_step_) return end(Outcome::kTimeout, situation());
  return false;
}

bool TrialLoop::all_at_rest() const {
  return (!goal_moves_ || at_rest(goal_of(world_, goal_index_).motion, time(k_))) &&
         (!objects_move_ || std::ranges::all_of(world_.objects, [&](const WorldObject& object) {
           return at_rest(object.motion, time(k_));
         }));
}

std::string TrialLoop::joint_over_limit() const {
  const VectorX& q = plant_.state().q;
  for (int i = 0; i < model_.num_joints(); ++i) {
    const ControlledJoint& joint = model_.joint(i);
    if (q[i] < joint.lower - kJointLimitTolerance || q[i] > joint.upper + kJointLimitTolerance)
      return fmt::format("{} at {:.4g} is outside [{:.4g}, {:.4g}]", joint.name, q[i], joint.lower, joint.upper);
  }
  return {};
}

/// Describes the robot's situation: what may hold it.
std::string TrialLoop::situation() {
  const StateRecord& now = r_.states.back();
  std::string text = fmt::format("{:.3g} m and {:.3g} rad from the goal", now.position_error, now.orientation_error);
  const auto pairs = proximity_.query(kinematics_, objects_, {0.3, -1.0, -1.0});
  const auto nearest = std::ranges::min_element(
      pairs, [](const ProximityPair& a, const ProximityPair& b) { return a.distance.d < b.distance.d; });
  if (nearest != pairs.end()) {
    text += fmt::format("; {} is {:.3g} m from {}", model_.shape(nearest->first).name, nearest->distance.d,
                        world_.objects[static_cast<std::size_t>(nearest->second)].name);
  }
  double margin = 0.1;  // rad or m; joints further inside are not mentioned
  std::string joint_text;
  const VectorX& q = plant_.state().q;
  for (int i = 0; i < model_.num_joints(); ++i) {
    const ControlledJoint& joint = model_.joint(i);
    const double inside = std::min(q[i] - joint.lower, joint.upper - q[i]);
    if (inside >= margin) continue;
    margin = inside;
    joint_text = fmt::format("; {} is {:.3g} from its limit", joint.name, inside);
  }
  return text + joint_text;
}

/// Records the latencies that the controller identified, and their differences from the configured ones.
void TrialLoop::note_latencies() {
  const PredictionParams& told = spec_.controller_params.prediction;
  if (!r_.has_prediction || r_.trace.empty()) return;
  const auto note = [this](double found, double drive, double sensing, double& latency, double& off) {
    if (found < 0.0) return;
    latency = found;
    const long configured = delay_steps(drive, period_) + delay_steps(sensing, period_);
    off = period_ * static_cast<double>(std::lround(found / period_) - configured);
  };
  TrialRow& row = r_.row;
  note(result_.latency_base, told.base_drive, told.base_sensing, row.latency_base_s, row.latency_base_off_s);
  note(result_.latency_joints, told.joint_drive, told.joint_sensing, row.latency_joints_s, row.latency_joints_off_s);
}

std::string TrialLoop::link_of(int shape) const {
  const CollisionShape& of = model_.shape(shape);
  return model_.carried && &of == &model_.shapes.back()
             ? "carried:" + world_.objects[static_cast<std::size_t>(model_.carried->object)].name
             : model_.link(of.link).name;
}

/// The contacts are sorted by time; the first one names the pair.
void TrialLoop::describe_contacts(TrialRow& row) const {
  const Contact& contact = report_.contacts.front();
  row.collision_count = static_cast<int>(report_.contacts.size());
  row.collision_time_s = contact.time;
  row.collision_depth_m = 0.0;
  for (const Contact& each : report_.contacts) {
    row.collision_time_s = std::min(row.collision_time_s, each.time);
    row.collision_depth_m = std::max(row.collision_depth_m, each.depth);
  }
  row.link = link_of(contact.first);
  switch (contact.kind) {
    case PairKind::kObject:
      row.object = world_.objects[static_cast<std::size_t>(contact.second)].name;
      break;
    case PairKind::kFloor:
      row.object = "floor";
      break;
    case PairKind::kSelf:
      row.object = "self:" + link_of(contact.second);
      break;
  }
  row.reason = fmt::format("{} touches {} at {:.3f} s, {:.2g} m deep{}", row.link, row.object, contact.time,
                           contact.depth, contact.by_ode ? "" : " (by the distance library)");
}

TrialRow run_loop(const TrialSpec& spec, const World& world, Plant& plant, StepController& controller,
                  Recording& recording, ProfileClock* profile) {
  using Clock = std::chrono::steady_clock;
  recording.has_qp = has_qp(spec);
  recording.has_prediction = spec.plugin == nullptr && spec.controller_params.prediction.enabled;
  recording.has_slack = recording.has_qp && spec.controller_params.slack.enabled;
  TrialLoop loop(spec, world, plant, recording, profile);
  controller.reset(loop.objects());
  controller.prepare(loop.answer());
  while (loop.sense()) {
    loop.show(controller);
    enter(profile, TrialPart::kController);
    const Clock::time_point before = Clock::now();
    controller.step(loop.seen(), loop.answer());
    const double seconds = std::chrono::duration<double>(Clock::now() - before).count();
    if (const std::string_view failure = controller.failure(); !failure.empty())
      throw std::runtime_error(fmt::format("at t = {:.4g} s {}", loop.seen().time, failure));
    loop.act(seconds);
  }
  return loop.finish();
}

}  // namespace moma
