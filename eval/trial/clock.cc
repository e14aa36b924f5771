#include "eval/trial/clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>

#include "controller/model/kinematics.h"
#include "controller/model/manipulability.h"
#include "eval/trial/clearance.h"
#include "eval/trial/rules.h"
#include "world/draws.h"
#include "world/sensing/actuation.h"
#include "world/sensing/sensing.h"
#include "world/sensing/streams.h"

namespace moma {

namespace {

/// Fills `observation` with the true state at time t, the only way of information to a controller;
/// world/sensing/sensing.h then disturbs it. Keeps sizes of `observation` that fit, so that only the first step
/// allocates.
void observe(const PlantState& truth, const std::vector<ObjectState>& objects, const GoalState& goal, double t,
             Observation& observation) {
  observation.time = t;
  observation.base = truth.base;
  observation.q = truth.q;
  observation.qdot = truth.qdot;
  observation.goal = goal;
  observation.objects = objects;
}

using Clock = std::chrono::steady_clock;

struct Ending {
  Outcome outcome = Outcome::kError;
  std::string reason;
};

// |x| + |y| + |z| + |roll| + |pitch| + |yaw| of X_EG.
double l1_error(const Isometry& X_WE, const Isometry& X_WG) {
  const Isometry X_EG = X_WE.inverse() * X_WG;
  return X_EG.translation().lpNorm<1>() + rpy_of(X_EG.linear()).lpNorm<1>();
}

}  // namespace

class TickClock::Impl {
 public:
  Impl(const TrialSpec& spec, const World& world, Plant& plant, Recording& recording, ProfileClock* clock)
      : spec_(spec),
        world_(world),
        model_(*spec.robot->model),
        plant_(plant),
        r_(recording),
        clock_(clock),
        period_(spec.simulation.control_period),
        kinematics_(spec.robot->model),
        proximity_(spec.robot->model),
        clearance_(spec.robot->model, world),
        dwell_(spec.success, period_),
        stuck_(spec.stuck, any(spec.disturbances), period_),
        infeasible_(spec.infeasible, period_),
        separation_(spec),
        ends_at_limits_(spec.simulation.joint_limits != AtJointLimit::kIgnore) {
    prepare();
    last_step_ = std::max(1L, periods_in(spec_.simulation.time_limit, period_));
    plant_.check_start(report_);
  }

  std::span<const ObjectShape> objects() const noexcept { return told_; }
  const Observation& seen() const noexcept { return observation_; }
  StepResult& answer() noexcept { return result_; }
  void truth(Observation& out) const { observe(plant_.state(), objects_, goal_, time(k_), out); }

  bool sense() {
    while (measure_and_look()) {
      if (!misses(k_)) return true;
      apply_answer();
    }
    return false;
  }

  void look_last() {
    if (finite_) look();
  }

  void act(double seconds) {
    r_.step_seconds.push_back(seconds);
    if (result_.solve_seconds > 0.0) r_.solve_seconds.push_back(result_.solve_seconds);
    apply_answer();
  }

  TrialRow finish() {
    r_.separation = separation_.least();
    note_latencies();
    TrialRow row = measure(r_, model_);
    row.outcome = ending_.outcome;
    row.reason = std::move(ending_.reason);
    row.time_end_s = time(k_);
    if (row.outcome == Outcome::kSuccess) row.time_to_goal_s = time(dwell_.first());
    if (row.outcome == Outcome::kCollision) describe_contact(row);
    return row;
  }

 private:
  void look() {
    observe(plant_.state(), objects_, goal_, time(k_), observation_);
    if (sensing_) sensing_->sense(k_, observation_);
  }

  bool measure_and_look() {
    enter(clock_, TrialPart::kMetrics);
    take_report();
    finite_ = measure_state(k_);
    if (finite_) compare_detectors(k_);
    if (end_at(k_, last_step_, finite_, ending_)) return false;
    enter(clock_, TrialPart::kSensing);
    look();
    return true;
  }

  bool misses(long k) const {
    const double missed = spec_.disturbances.control.missed;
    if (k == 0 || !(missed > 0.0)) return false;
    const DisturbanceStreams streams(world_, spec_.disturbances.seed);
    return streams.sensing(DisturbanceSource::kMissedTick, k).uniform() < missed;
  }

  // Lets the plant follow the last answer for a period, and records a sample.
  void apply_answer() {
    enter(clock_, TrialPart::kMetrics);
    if (result_.command.size() != model_.num_velocities() || !result_.command.allFinite()) {
      throw std::runtime_error(fmt::format("the controller's command at t = {:.4g} s is not {} finite numbers",
                                           time(k_), model_.num_velocities()));
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
    infeasible_.count(result_.fallback);
    enter(clock_, TrialPart::kSensing);
    const VectorX& command = actuation_ ? actuation_->act(k_, result_.command) : result_.command;
    enter(clock_, TrialPart::kPlant);
    plant_.advance(command, period_, report_);
    ++k_;
  }

  void prepare() {
    const std::vector<ObjectShape> shapes = object_shapes(world_);
    proximity_.set_objects(shapes);
    objects_.resize(world_.objects.size());
    object_states(world_, 0.0, objects_);
    goal_ = goal_state(world_, 0.0);
    objects_move_ = std::any_of(world_.objects.begin(), world_.objects.end(),
                                [](const WorldObject& object) { return !at_rest(object.motion, 0.0); });
    goal_moves_ = !at_rest(world_.goal.motion, 0.0);
    const Disturbances& disturbances = spec_.disturbances;
    if (senses_with_errors(disturbances)) sensing_.emplace(disturbances, model_, world_, period_);
    told_ = shapes;
    if (sensing_)
      for (ObjectShape& phantom : sensing_->phantoms(world_)) told_.push_back(std::move(phantom));
    if (acts_with_errors(disturbances)) actuation_.emplace(disturbances, model_, world_, period_);
    r_.control_period = period_;
    r_.moving_goal = goal_moves_;
    r_.dynamic = spec_.simulation.mode == SimulationMode::kDynamic;
    r_.has_wheels = r_.dynamic && model_.base_dof() > 0;
    const auto expected = static_cast<std::size_t>(std::min(periods_in(spec_.simulation.time_limit, period_), 4096L));
    r_.trace.reserve(expected);
    r_.states.reserve(expected + 1);
    r_.step_seconds.reserve(expected);
  }

  double time(long k) const { return static_cast<double>(k) * period_; }

  void take_report() {
    r_.energy += report_.energy;
    r_.slip_max = std::max(r_.slip_max, report_.slip_max);
    r_.lcp_messages += report_.lcp_messages;
    r_.redone_steps += report_.redone_steps;
    r_.divided_steps += report_.divided_steps;
  }

  // Compares the detectors at steps drawn from the world's own stream, and in every state that ends a trial by a
  // contact.
  void compare_detectors(long k) {
    const double rate = spec_.simulation.cross_check;
    if (!(rate > 0.0)) return;
    Draws draws(world_.seed, world_.index, Stream::kCrossCheck, static_cast<std::uint64_t>(k));
    if (draws.uniform() >= rate && report_.contacts.empty()) return;
    const DetectorCheck found = plant_.cross_check();
    ++r_.detector_checks;
    r_.detectors.disagreements += found.disagreements;
    r_.detectors.deepest = std::max(r_.detectors.deepest, found.deepest);
  }

  // Measures errors, distances and all other quantities of the state. False if the state is not finite.
  bool measure_state(long k) {
    const PlantState& state = plant_.state();
    if (!state.base.allFinite() || !state.q.allFinite() || !state.qdot.allFinite()) return false;
    if (objects_move_ && k > 0) object_states(world_, time(k), objects_);
    if (goal_moves_ && k > 0) goal_ = goal_state(world_, time(k));
    kinematics_.update(state.base, state.q);
    const Isometry& X_WE = kinematics_.X_WE();
    error_.head<3>() = log_so3(goal_.X_WG.linear() * X_WE.linear().transpose());
    error_.tail<3>() = goal_.X_WG.translation() - X_WE.translation();

    r_.last = state;
    StateRecord& record = r_.states.emplace_back();
    record.p_WE = X_WE.translation();
    record.orientation_error = error_.head<3>().norm();
    record.position_error = error_.tail<3>().norm();
    if (std::isfinite(spec_.success.l1)) record.l1_error = l1_error(X_WE, goal_.X_WG);
    const auto J_arm = kinematics_.J_WE_W().rightCols(model_.num_joints());
    record.manipulability = manipulability(J_arm, ManipulabilityRows::kTranslation);
    record.manipulability_all = manipulability(J_arm, ManipulabilityRows::kAll);
    clearance_.look(kinematics_, objects_, objects_move_);
    r_.clearance = clearance_.to_objects();
    r_.clearance_self = clearance_.to_itself();
    if (objects_move_) separation_.look(kinematics_, proximity_, objects_, state.qdot);
    return true;
  }

  bool end_at(long k, long last_step, bool finite, Ending& ending) {
    const auto end = [&ending](Outcome outcome, std::string reason) {
      ending = {outcome, std::move(reason)};
      return true;
    };
    if (!report_.contacts.empty()) {
      r_.contacts = report_.contacts;
      return end(Outcome::kCollision, {});
    }
    if (!finite) return end(Outcome::kDiverged, report_.reason.empty() ? "the state is not finite" : report_.reason);
    const StateRecord& now = r_.states.back();
    if (dwell_.update(k, now.position_error, now.orientation_error, now.l1_error)) return end(Outcome::kSuccess, {});
    if (report_.diverged) return end(Outcome::kDiverged, report_.reason);
    if (report_.tipped) return end(Outcome::kTipped, report_.reason);
    if (std::string over = joint_over_limit(); !over.empty() && ends_at_limits_)
      return end(Outcome::kJointLimit, std::move(over));
    if (infeasible_.reached())
      return end(Outcome::kInfeasible, fmt::format("no solved QP for {} s; {}", spec_.infeasible.time, situation()));
    if (stuck_.update(k, plant_.state(), [&] { return all_at_rest(k); }) && !dwell_.inside())
      return end(Outcome::kStuck, fmt::format("nothing moved for {} s; {}", stuck_.time(), situation()));
    if (k >= last_step) return end(Outcome::kTimeout, situation());
    return false;
  }

  bool all_at_rest(long k) const {
    return (!goal_moves_ || at_rest(world_.goal.motion, time(k))) &&
           (!objects_move_ || std::all_of(world_.objects.begin(), world_.objects.end(),
                                          [&](const WorldObject& object) { return at_rest(object.motion, time(k)); }));
  }

  std::string joint_over_limit() const {
    const VectorX& q = plant_.state().q;
    for (int i = 0; i < model_.num_joints(); ++i) {
      const ControlledJoint& joint = model_.joints[static_cast<std::size_t>(i)];
      if (q[i] < joint.lower - kJointLimitTolerance || q[i] > joint.upper + kJointLimitTolerance)
        return fmt::format("{} at {:.4g} is outside [{:.4g}, {:.4g}]", joint.name, q[i], joint.lower, joint.upper);
    }
    return {};
  }

  // Describes the robot's situation: what may hold it.
  std::string situation() {
    const StateRecord& now = r_.states.back();
    std::string text = fmt::format("{:.3g} m and {:.3g} rad from the goal", now.position_error, now.orientation_error);
    double nearest = kInfinity;
    int object = -1, shape = -1;
    for (const ProximityPair& pair : proximity_.query(kinematics_, objects_, {0.3, -1.0, -1.0})) {
      if (pair.distance.d >= nearest) continue;
      nearest = pair.distance.d;
      object = pair.second;
      shape = pair.first;
    }
    if (object >= 0) {
      text += fmt::format("; {} is {:.3g} m from {}", model_.shapes[static_cast<std::size_t>(shape)].name, nearest,
                          world_.objects[static_cast<std::size_t>(object)].name);
    }
    double margin = 0.1;  // rad or m; joints further inside are not mentioned
    std::string joint_text;
    const VectorX& q = plant_.state().q;
    for (int i = 0; i < model_.num_joints(); ++i) {
      const ControlledJoint& joint = model_.joints[static_cast<std::size_t>(i)];
      const double inside = std::min(q[i] - joint.lower, joint.upper - q[i]);
      if (inside >= margin) continue;
      margin = inside;
      joint_text = fmt::format("; {} is {:.3g} from its limit", joint.name, inside);
    }
    return text + joint_text;
  }

  // Records the latencies that the controller identified, and their differences from the configured ones.
  void note_latencies() {
    const PredictionParams& told = spec_.controller_params.prediction;
    if (!r_.has_prediction || r_.trace.empty()) return;
    const auto periods = [this](double seconds) { return delay_steps(seconds, period_); };
    const auto off = [this](double found, long configured) {
      return period_ * static_cast<double>(std::lround(found / period_) - configured);
    };
    if (result_.latency_base >= 0.0) {
      r_.latency_base = result_.latency_base;
      r_.latency_base_off = off(r_.latency_base, periods(told.base_drive) + periods(told.base_sensing));
    }
    if (result_.latency_joints >= 0.0) {
      r_.latency_joints = result_.latency_joints;
      r_.latency_joints_off = off(r_.latency_joints, periods(told.joint_drive) + periods(told.joint_sensing));
    }
  }

  std::string link_of(int shape) const {
    return model_.links[static_cast<std::size_t>(model_.shapes[static_cast<std::size_t>(shape)].link)].name;
  }

  void describe_contact(TrialRow& row) const {
    const Contact& contact = r_.contacts.front();
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

  const TrialSpec& spec_;
  const World& world_;
  const RobotModel& model_;
  Plant& plant_;
  Recording& r_;
  ProfileClock* clock_;
  const double period_;
  Kinematics kinematics_;
  Proximity proximity_;
  ClearanceWatch clearance_;
  DwellRule dwell_;
  StuckTracker stuck_;
  InfeasibleTracker infeasible_;
  SeparationWatch separation_;
  bool ends_at_limits_;
  std::optional<Sensing> sensing_;      // only if the controller does not see the true state
  std::optional<Actuation> actuation_;  // only if the plant gets another command than the controller's
  PlantReport report_;
  Observation observation_;
  StepResult result_;
  std::vector<ObjectState> objects_;
  GoalState goal_;
  Vector6 error_ = Vector6::Zero();
  bool objects_move_ = false;
  bool goal_moves_ = false;
  bool finite_ = true;
  std::vector<ObjectShape> told_;  // the objects that the controller knows
  long k_ = 0;                     // index of the sample
  long last_step_ = 0;
  Ending ending_;
};

TickClock::TickClock(const TrialSpec& spec, const World& world, Plant& plant, Recording& recording,
                     ProfileClock* profile)
    : impl_(std::make_unique<Impl>(spec, world, plant, recording, profile)) {}
TickClock::~TickClock() = default;
std::span<const ObjectShape> TickClock::objects() const noexcept { return impl_->objects(); }
bool TickClock::sense() { return impl_->sense(); }
void TickClock::look_last() { impl_->look_last(); }
const Observation& TickClock::seen() const noexcept { return impl_->seen(); }
void TickClock::truth(Observation& out) const { impl_->truth(out); }
StepResult& TickClock::answer() noexcept { return impl_->answer(); }
void TickClock::act(double seconds) { impl_->act(seconds); }
TrialRow TickClock::finish() { return impl_->finish(); }

TrialRow run_clock(const TrialSpec& spec, const World& world, Plant& plant, StepController& controller,
                   Recording& recording, ProfileClock* profile) {
  recording.has_qp = has_qp(spec);
  recording.has_prediction = spec.plugin == nullptr && spec.controller_params.prediction.enabled;
  recording.has_slack = recording.has_qp && spec.controller_params.slack.enabled;
  TickClock clock(spec, world, plant, recording, profile);
  controller.reset(clock.objects());
  controller.prepare(clock.answer());
  while (clock.sense()) {
    enter(profile, TrialPart::kController);
    const Clock::time_point before = Clock::now();
    controller.step(clock.seen(), clock.answer());
    const double seconds = std::chrono::duration<double>(Clock::now() - before).count();
    if (const std::string_view failure = controller.failure(); !failure.empty())
      throw std::runtime_error(fmt::format("at t = {:.4g} s {}", clock.seen().time, failure));
    clock.act(seconds);
  }
  return clock.finish();
}

}  // namespace moma
