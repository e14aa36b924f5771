#include "controller/ahead/lookahead.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "controller/ahead/candidates.h"
#include "controller/task/vortex.h"

namespace moma {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
// Of a rollout's step, in checks: what it takes, measured.
constexpr long kRolloutChecks = 6;
// A goal that is elsewhere from one step to the next by more than this has jumped.
constexpr double kJump = 0.02, kJumpTurn = 0.05;  // [m, rad]
constexpr double kStill = 1e-6;                   // of a goal's twist
constexpr double kNearMover = 2.5;                // from the base to an object in motion [m]
constexpr double kSlow = 0.1;                     // velocities at which a robot stands, to choose [rad/s, m/s]
constexpr double kLongestStop = 1.0;              // [s]
constexpr double kArrived = 0.03;                 // lag at a path's end [m]
constexpr double kGain = 0.1;                     // of a detour over the best so far, at least [s]
constexpr double kThere = 0.3;                    // a goal that is reached so soon needs no choice [s]
constexpr double kSure = 0.7;                     // part of the tolerances within which a prediction arrives
constexpr double kProgress = 0.05;                // on the path's clock that is progress [s]
constexpr double kPushed = 0.3;                   // lag among objects in motion that gives a path up [m]
// Robot and object on their ways meet: the path's clock slows down from so soon on, and stands from so soon on [s].
constexpr double kMeetAhead = 2.0, kMeetNear = 0.5;
constexpr int kTrusted = 3;  // choices after which detours, which were not kept, give way to paths
// While a path is followed a moment of it costs more than anything else in a step: few of them.
constexpr long kWatched = 40;

ControllerParams without_plan(ControllerParams params) {
  params.plan.enabled = false;
  return params;
}

ControllerParams late_limits(ControllerParams params) {
  constexpr double kInfluence = 0.3, kStop = 0.05;  // [rad]
  params.joint_limits.influence = std::min(params.joint_limits.influence, kInfluence);
  params.joint_limits.stop = std::min(params.joint_limits.stop, kStop);
  return params;
}

bool jumped(const Isometry& from, const Isometry& to) noexcept {
  return (from.translation() - to.translation()).norm() > kJump ||
         log_so3(from.linear() * to.linear().transpose()).norm() > kJumpTurn;
}

}  // namespace

Lookahead::Lookahead(std::shared_ptr<const RobotModel> model, const ControllerParams& params, double control_period)
    : params_(params.plan),
      escape_(params.escape),
      dt_(control_period),
      base_(model->base.type),
      planner_(model, params),
      watch_(model, planner_.limits()),
      bounds_(*model, late_limits(params), control_period),
      rollout_(model, without_plan(params), params.plan.step),
      kinematics_(model),
      wanted_(VectorX::Zero(model->num_velocities())) {
  candidates_.reserve(2 + kCandidates);
  chosen_from_.q = model->ready;
  chosen_from_.qdot = wanted_;
  state_.path.origin = WholeConfiguration::Zero(3 + model->num_joints());
}

void Lookahead::reset(std::span<const ObjectShape> objects) {
  planner_.set_objects(objects);
  watch_.set_objects(objects);
  rollout_.reset(objects);
  chosen_from_.objects.assign(objects.size(), ObjectState{});
  candidates_.clear();
  WholeConfiguration origin = WholeConfiguration::Zero(3 + planner_.limits().num_joints());
  state_ = PlanState{};
  state_.path.origin = origin;
  job_ = Job::kNone;
  debt_ = checks_ = 0;
  news_ = guides_ = anew_ = false;
}

void Lookahead::set_state(const PlanState& state) noexcept {
  state_ = state;
  job_ = Job::kNone;
  debt_ = 0;
  news_ = false;
  watch_.forget();
}

std::int64_t Lookahead::periods(double seconds) const noexcept { return std::llround(seconds / dt_); }

void Lookahead::go_direct(PlanReason reason, const EscapeState* start) noexcept {
  state_.brief.mode = PlanMode::kDirect;
  state_.brief.reason = reason;
  state_.brief.clock = state_.brief.duration = state_.brief.lag = 0.0;
  state_.path.count = 0;
  job_ = Job::kNone;
  if (start == nullptr) return;
  state_.fresh = true;
  state_.start = *start;
  state_.stagnations = start->idle >= escape_.patience ? 1 : 0;
}

void Lookahead::stop(PlanReason reason, double direct_time) noexcept {
  state_.left_path = state_.brief.mode == PlanMode::kFollow;
  state_.brief.mode = PlanMode::kStop;
  state_.brief.reason = reason;
  state_.direct_time = direct_time;
  state_.stop_end = state_.steps + periods(kLongestStop);
  job_ = Job::kNone;
}

bool Lookahead::near_mover(const Observation& o) const noexcept {
  for (const ObjectState& object : o.objects)
    if (object.visible && in_motion(object) &&
        (object.X_WO.translation() - o.base).head<2>().squaredNorm() < kNearMover * kNearMover)
      return true;
  return false;
}

void Lookahead::decide(const Observation& o) noexcept {
  const EscapeState kNothing;
  if (state_.has_goal && jumped(state_.X_WG, o.goal.X_WG)) {
    const bool was_direct = state_.brief.mode == PlanMode::kDirect;
    go_direct(PlanReason::kStart, was_direct ? nullptr : &kNothing);
    state_.steps = state_.next = 0;
  }
  state_.X_WG = o.goal.X_WG;
  state_.has_goal = true;
  int known = 0;
  bool movers = false;
  for (const ObjectState& object : o.objects) {
    known += object.visible ? 1 : 0;
    movers = movers || (object.visible && in_motion(object));
  }
  news_ = news_ || known != state_.known;
  state_.known = known;
  const bool goal_moves = o.goal.V_WG_W.norm() >= kStill;
  traffic_ = movers || goal_moves;
  PlanBrief& brief = state_.brief;
  if (goal_moves && brief.mode != PlanMode::kDirect) go_direct(PlanReason::kTraffic, &kNothing);
  if (movers && !goal_moves) decide_among_traffic();

  if (brief.mode == PlanMode::kStop && (o.qdot.lpNorm<Eigen::Infinity>() <= kSlow || state_.steps >= state_.stop_end))
    brief.mode = PlanMode::kChoose;
  guides_ = brief.mode != PlanMode::kDirect;
  wanted_.setZero();
  if (brief.mode == PlanMode::kFollow) follow(o);
  anew_ = state_.fresh;
  if (anew_) {
    anew_start_ = state_.start;
    state_.fresh = false;
  }
  ++state_.steps;
}

// Pushed off its path or held up by what moves, the robot is the policy's again.
void Lookahead::decide_among_traffic() noexcept {
  const EscapeState kNothing;
  if (state_.brief.mode != PlanMode::kFollow) return;
  if (state_.brief.lag > kPushed || state_.steps - state_.mark > periods(2.0 * params_.stuck))
    go_direct(PlanReason::kTraffic, &kNothing);
}

void Lookahead::follow(const Observation& o) noexcept {
  PlanBrief& brief = state_.brief;
  shift_ = shift_of_goal(base_, state_.path.X_WG, o.goal.X_WG);
  // The clock waits for what will pass.
  long looks = kWatched;
  const double met =
      traffic_ ? watch_.met_after(state_.path, shift_, brief.clock, kMeetAhead, state_.path.clearance, o.objects, looks)
               : kMeetAhead;
  const double most_rate = std::clamp((met - kMeetNear) / (kMeetAhead - kMeetNear), 0.0, 1.0);
  const FollowStep step =
      follow_path(planner_.limits(), params_, state_.path, brief.clock, dt_, most_rate, shift_, o, wanted_);
  brief.lag = step.lag;
  brief.clock = std::min(brief.clock + step.rate * dt_, state_.path.duration);
  if (brief.clock > state_.mark_clock + kProgress) {
    state_.mark_clock = brief.clock;
    state_.mark = state_.steps;
  }
}

void Lookahead::work(const Observation& o, const EscapeState& escape) noexcept {
  const EscapeState kNothing;
  long budget = params_.budget - debt_;
  const long whole = budget;
  PlanBrief& brief = state_.brief;
  switch (brief.mode) {
    case PlanMode::kDirect:
    case PlanMode::kFollow: {
      if (brief.mode == PlanMode::kFollow) watch_path(o, budget);
      const bool follows = brief.mode == PlanMode::kFollow;
      if (!follows && brief.mode != PlanMode::kDirect) break;
      const bool goal_moves = o.goal.V_WG_W.norm() >= kStill;
      const bool stagnated = !follows && escape.stagnations > state_.stagnations;
      state_.stagnations = state_.fresh ? state_.stagnations : escape.stagnations;
      if (traffic_ && !follows && (goal_moves || !stagnated || near_mover(o))) {
        job_ = Job::kNone;
        state_.next = state_.steps;
        break;
      }
      if (stagnated) {
        stop(PlanReason::kStagnates, -1.0);
        break;
      }
      if (follows && at_end()) {
        go_direct(PlanReason::kPathEnds, &kNothing);
        break;
      }
      if (job_ == Job::kNone && (state_.steps >= state_.next || news_ || (follows && stuck())))
        begin_prediction(o, escape);
      if (job_ == Job::kPredict) {
        run_rollout(budget);
        if (job_ == Job::kNone) end_prediction();
      }
      break;
    }
    case PlanMode::kStop:
      break;
    case PlanMode::kChoose:
      if (job_ == Job::kNone) begin_choice(o);
      if (job_ == Job::kPlan && !planner_.advance(budget)) {
        candidates_.push_back({PlanCandidate::Kind::kPath, 0, -1.0});
        if (planner_.found()) {
          candidates_.back().time = planner_.path().duration + params_.settle;
          if (candidates_.back().time < least_) {
            least_ = candidates_.back().time;
            best_ = static_cast<int>(candidates_.size()) - 1;
          }
        }
        const bool detours = params_.detours && (state_.brief.attempts <= kTrusted || !planner_.found());
        detour_ = detours ? 0 : kCandidates;
        next_detour();
      }
      while (job_ == Job::kDetours && budget > 0) {
        run_rollout(budget);
        if (job_ != Job::kNone) break;
        candidates_.push_back({PlanCandidate::Kind::kDetour, detour_ - 1, -1.0});
        if (rollout_.end() == RolloutEnd::kArrives) {
          least_ = candidates_.back().time = rollout_.time();
          best_ = static_cast<int>(candidates_.size()) - 1;
        }
        next_detour();
      }
      if (job_ == Job::kNone) choose();
      break;
  }
  checks_ = whole - budget;
  debt_ = std::max(0L, -budget);
}

void Lookahead::run_rollout(long& budget) noexcept {
  while (budget > 0) {
    const RolloutEnd end = rollout_.step();
    budget -= kRolloutChecks;
    if (end == RolloutEnd::kGoesOn && !rollout_.over()) continue;
    job_ = Job::kNone;
    return;
  }
}

void Lookahead::watch_path(const Observation& o, long& budget) noexcept {
  long looks = std::min(budget, kWatched);
  const long before = looks;
  const bool holds = watch_.holds(state_.path, shift_, state_.brief.clock, o.objects, looks);
  budget -= before - looks;
  if (!holds) stop(PlanReason::kPathBroken, -1.0);
}

void Lookahead::begin_prediction(const Observation& o, const EscapeState& escape) noexcept {
  const EscapeState kNothing;
  rollout_.begin(o, state_.brief.mode == PlanMode::kDirect ? escape : kNothing,
                 {params_.horizon, params_.touch, kSure * escape_.position, kSure * escape_.orientation, true});
  news_ = false;
  job_ = Job::kPredict;
}

void Lookahead::end_prediction() noexcept {
  const EscapeState kNothing;
  PlanBrief& brief = state_.brief;
  const bool arrives = rollout_.end() == RolloutEnd::kArrives;
  const double time = arrives ? rollout_.time() : kNever;
  const bool first = state_.next == 0;
  state_.next = state_.steps + periods(params_.period);
  if (brief.mode == PlanMode::kDirect) {
    if (time < kThere) return;
    if (!arrives)
      stop(PlanReason::kFails, -1.0);
    else if (first)
      stop(PlanReason::kStart, time);
    else
      brief.reason = PlanReason::kArrives;
    return;
  }
  if (time <= state_.path.duration - brief.clock + params_.settle)
    go_direct(PlanReason::kArrives, &kNothing);
  else if (stuck())
    stop(PlanReason::kNoProgress, -1.0);
}

bool Lookahead::stuck() const noexcept {
  return state_.steps - state_.mark > periods((traffic_ ? 4.0 : 1.0) * params_.stuck);
}

bool Lookahead::at_end() const noexcept {
  return state_.brief.clock >= state_.path.duration && (state_.brief.lag < kArrived || stuck());
}

void Lookahead::begin_choice(const Observation& o) noexcept {
  chosen_from_.time = o.time;
  chosen_from_.base = o.base;
  chosen_from_.q = o.q;
  chosen_from_.qdot = o.qdot;
  chosen_from_.goal = o.goal;
  std::copy_n(o.objects.begin(), std::min(o.objects.size(), chosen_from_.objects.size()), chosen_from_.objects.begin());
  candidates_.clear();
  candidates_.push_back({PlanCandidate::Kind::kDirect, 0, state_.direct_time});
  least_ = state_.direct_time >= 0.0 ? state_.direct_time : kNever;
  best_ = 0;
  WholeConfiguration start(3 + o.q.size());
  start << o.base, o.q;
  planner_.begin(start, o.goal.X_WG, o.objects, static_cast<std::uint64_t>(state_.brief.attempts++));
  kinematics_.update(o.base, o.q);
  job_ = Job::kPlan;
}

void Lookahead::next_detour() noexcept {
  if (detour_ == kCandidates) {
    job_ = Job::kNone;
    return;
  }
  const EscapeState from = candidate(escape_, kinematics_, chosen_from_.goal, detour_++);
  rollout_.begin(chosen_from_, from,
                 {std::min(params_.horizon, least_ - kGain), params_.touch, kSure * escape_.position,
                  kSure * escape_.orientation, true});
  job_ = Job::kDetours;
}

// The quickest counts; where nothing arrives, the direct policy goes on, anew where it was not the policy's turn.
void Lookahead::choose() noexcept {
  const EscapeState kNothing;
  const PlanCandidate& best = candidates_[static_cast<std::size_t>(best_)];
  PlanBrief& brief = state_.brief;
  state_.next = state_.steps + periods(params_.period);
  if (best.time < 0.0) {
    go_direct(PlanReason::kNoPath, state_.left_path ? &kNothing : nullptr);
  } else if (best.kind == PlanCandidate::Kind::kPath) {
    brief.mode = PlanMode::kFollow;
    brief.reason = PlanReason::kQuicker;
    state_.path = planner_.path();
    brief.clock = brief.lag = 0.0;
    brief.duration = state_.path.duration;
    state_.mark = state_.steps;
    state_.mark_clock = 0.0;
    watch_.forget();
  } else if (best.kind == PlanCandidate::Kind::kDetour) {
    const EscapeState from = candidate(escape_, kinematics_, chosen_from_.goal, best.index);
    go_direct(PlanReason::kQuicker, &from);
  } else {
    go_direct(PlanReason::kQuicker, state_.left_path ? &kNothing : nullptr);
  }
}

}  // namespace moma
