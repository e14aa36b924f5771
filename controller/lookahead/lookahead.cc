#include "controller/lookahead/lookahead.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "controller/model/proximity.h"
#include "controller/step_described.h"

namespace moma {
namespace {

constexpr std::int64_t kHurry = 3;  // steps before a choice has to be made
// Most moments of a path that are checked in one step: each costs more than all else in it.
constexpr long kWatched = 40;

ControllerParams without_plan(ControllerParams params) {
  params.plan.enabled = false;
  return params;
}

ControllerParams late_limits(ControllerParams params) {
  params.joint_limits.influence = std::min(params.joint_limits.influence, params.plan.follow.joint_influence);
  params.joint_limits.stop = std::min(params.joint_limits.stop, params.plan.follow.joint_stop);
  return params;
}

// `V`: motion of the goal between the two that is no jump.
bool jumped(const DecisionParams& params, const Isometry& from, const Isometry& to,
            const Vector6& V = Vector6::Zero()) noexcept {
  return (from.translation() - to.translation()).norm() > params.goal_jump + V.tail<3>().norm() ||
         log_so3(from.linear() * to.linear().transpose()).norm() > params.goal_turn + V.head<3>().norm();
}

}  // namespace

Lookahead::Lookahead(std::shared_ptr<const RobotModel> model, const ControllerParams& params, double control_period)
    : params_(params.plan),
      escape_(params.escape),
      dt_(control_period),
      budget_(std::lround(std::clamp(params.plan.rate * control_period, 1.0, static_cast<double>(params.plan.budget)))),
      mobile_(model->mobile()),
      keeps_upright_(params.upright.enabled),
      choice_(model, params),
      slope_(params.collision.at_goal.slope),
      watch_(model, params.plan.decisions, planner().limits(), slope_),
      bounds_(*model, late_limits(params), control_period),
      rollout_(model, without_plan(params), params.plan.step),
      wanted_(VectorX::Zero(model->num_velocities())) {
  later_.q = model->ready;
  later_.qdot = wanted_;
  state_.path.origin = WholeConfiguration::Zero(3 + model->num_joints());
}

void Lookahead::reset(std::span<const ObjectShape> objects) {
  choice_.reset(objects);
  watch_.set_objects(objects);
  rollout_.reset(objects);
  later_.objects.assign(objects.size(), ObjectState{});
  later_time_ = -1.0;
  WholeConfiguration origin = WholeConfiguration::Zero(3 + planner().limits().num_joints());
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
  later_time_ = -1.0;
  watch_.forget();
}

// On the way to a close goal rows keep a share of the path's clearance only: the robot lags behind the path, objects
// are measured elsewhere than when it was planned, and where motions overlap it has half its clearance. On other paths
// of less than the clearance they keep what the path does, but no less than the last tier, however near the path
// begins.
KeptDistance Lookahead::keeps() const noexcept {
  const Path& path = state_.path;
  if (!std::holds_alternative<Following>(state_.doing)) return {};
  const double part = params_.follow.kept;
  if (path.close())
    return {part * path.kept_at_goal, part * slope_, (path.meets ? path.X_WG : state_.X_WG).translation(),
            std::min(part * path.clearance, path.arm_at_goal)};
  if (path.clearance >= params_.clearance) return {};
  return {.most = std::max(path.clearance, params_.tight())};
}

bool Lookahead::passes() const noexcept {
  const Path& path = state_.path;
  return std::holds_alternative<Following>(state_.doing) &&
         (path.close() || state_.brief.lag < (1.0 - params_.follow.kept) * path.clearance);
}

std::int64_t Lookahead::periods(double seconds) const noexcept { return std::llround(seconds / dt_); }

template <class Now>
void Lookahead::begin(const Now& now, PlanReason reason) noexcept {
  state_.doing = now;
  PlanBrief& brief = state_.brief;
  brief.going_on = state_.doing.index() == kGoingOn;
  brief.mode = brief.going_on ? PlanMode::kDirect : static_cast<PlanMode>(state_.doing.index());
  brief.reason = reason;
}

// Hands over to the policy.
void Lookahead::go_direct(PlanReason reason, Detours detours) noexcept {
  begin(GoingDirect{}, reason);
  PlanBrief& brief = state_.brief;
  brief.clock = brief.duration = brief.lag = 0.0;
  brief.target.setZero();
  brief.end.setZero();
  state_.path.count = 0;
  job_ = Job::kNone;
  if (detours == Detours::kKept) return;
  state_.clears_detours = true;
  state_.stagnations = 0;
}

void Lookahead::stop(PlanReason reason, double direct_time) noexcept {
  begin(Stopping{state_.steps + periods(params_.decisions.stop_time), direct_time}, reason);
  job_ = Job::kNone;
}

// True if the state in which the robot is predicted to be soon is known and safe.
bool Lookahead::goes_on_safely() const noexcept {
  const bool touches = rollout_.end() == RolloutEnd::kTouches && rollout_.time() < later_time_ + params_.decisions.sure;
  return later_time_ >= 0.0 && !touches && predicted_from_ + periods(later_time_) > state_.steps;
}

// Begins a choice for that state, or stops.
void Lookahead::go_on(PlanReason reason, double direct_time) noexcept {
  if (!goes_on_safely()) {
    stop(reason, direct_time);
    return;
  }
  if (direct_time >= 0.0) direct_time = std::max(0.0, direct_time - later_time_);
  begin(GoingOn{predicted_from_ + periods(later_time_), direct_time, false}, reason);
  choice_.begin(later_, direct_time, ++state_.brief.attempts);
  job_ = Job::kChoose;
}

// Begins to look for a direct way from that state, which would be quicker than the policy.
void Lookahead::look_for_way(double direct_time) noexcept {
  begin(GoingDirect{}, PlanReason::kArrives);
  if (params_.direct == 0 || !goes_on_safely()) return;
  direct_time -= later_time_;
  begin(GoingOn{predicted_from_ + periods(later_time_), direct_time, false}, PlanReason::kArrives);
  choice_.begin(later_, direct_time, state_.brief.attempts, false);
  job_ = Job::kChoose;
}

// Begins to follow state_.path.
void Lookahead::begin_path(PlanReason reason) noexcept {
  begin(Following{state_.steps}, reason);
  PlanBrief& brief = state_.brief;
  brief.clock = brief.lag = 0.0;
  brief.duration = state_.path.duration;
  brief.target = state_.path.origin.head<3>();
  shift_ = PlanarShift{};
  place_end();
  watch_.forget();
}

void Lookahead::place_end() noexcept {
  WholeConfiguration end;
  state_.path.at(state_.path.duration, end);
  state_.brief.end = shift_.of(end).head<3>();
}

// False if the robot is farther from where the path begins than the path is from objects.
bool Lookahead::begins_at(const Observation& o) const noexcept {
  WholeConfiguration begin;
  state_.path.at(0.0, begin);
  return path_lag(planner().limits(), params_, begin, o) <= state_.path.clearance;
}

void Lookahead::decide(const Observation& o, const Vector6& error, const Matrix3& R_WG, double drive,
                       int missed) noexcept {
  choice_.set_goal_axes(R_WG);
  choice_.set_drive(drive);
  if (keeps_upright_) choice_.keep_upright(o.upright);
  const RolloutLimits limits = prediction_limits(params_, escape_, params_.horizon);
  const double off = std::max(error.tail<3>().norm() / limits.position, error.head<3>().norm() / limits.orientation);
  arrived_ = off < 1.0;
  const bool stands = o.qdot.lpNorm<Eigen::Infinity>() <= params_.decisions.standing;
  // The robot went on in periods that were missed, on a path at its rate.
  state_.steps += missed;
  if (doing<Following>()) advance_clock(missed * dt_);
  if (state_.has_goal && jumped(params_.decisions, state_.X_WG, o.goal.X_WG, 2.0 * dt_ * o.goal.V_WG_W)) {
    Following* on_path = doing<Following>();
    Path& path = state_.path;
    const PlanarShift shift = shift_of_goal(mobile_ && is_whole(o.goal), path.X_WG, state_.X_WG);
    const bool onward = on_path && path.passes() && !jumped(params_.decisions, path.X_WN, shift.back(o.goal.X_WG));
    state_.missed = state_.left_last_part = state_.held_off = false;
    if (onward || (on_path && !stands && params_.direct > 0 && !path.close() && !path.meets)) {
      path.X_WG = shift.back(o.goal.X_WG);
      path.pass = kInfinity;
      *on_path = {0, state_.brief.clock, !onward};  // it stays on the path until a way on is known
      job_ = Job::kNone;
    } else {
      const bool was_direct = state_.brief.mode == PlanMode::kDirect;
      go_direct(PlanReason::kStart, was_direct ? Detours::kKept : Detours::kCleared);
    }
    state_.steps = state_.next = state_.next_onward = 0;
  }
  state_.X_WG = o.goal.X_WG;
  state_.has_goal = true;
  int known = 0;
  traffic_ = false;
  for (const ObjectState& object : o.objects) {
    // Boxes of a map come and go; the watch over the path looks at each of them.
    known += object.visible && object.box.isZero(0.0) ? 1 : 0;
    traffic_ = traffic_ || (object.visible && in_motion(object));
  }
  news_ = news_ || known != state_.known;
  state_.known = known;
  const bool goal_moves = in_motion(o.goal);
  PlanBrief& brief = state_.brief;
  if (doing<Following>() && (state_.path.meets != goal_moves || (traffic_ && brief.lag > params_.decisions.pushed)))
    go_direct(PlanReason::kTraffic, Detours::kCleared);
  if (state_.steps == 0 && doing<GoingDirect>() && params_.direct > 0 && stands && !goal_moves && !arrived_)
    begin(SettingOut{}, brief.reason);
  // Where the goal is measured better than before, a path's end lies beside it, or the policy's rows hold the hand off.
  const bool ended = arrived_ || (doing<Following>() && brief.clock >= state_.path.duration);
  const bool beside = ended && off > params_.decisions.beside && stands && !goal_moves;
  state_.steps_beside = beside && (doing<GoingDirect>() || doing<Following>()) ? state_.steps_beside + 1 : 0;
  if (state_.steps_beside > periods(params_.stuck)) {
    state_.steps_beside = 0;
    stop(PlanReason::kBesideGoal, -1.0);
  }
  if (const GoingOn* now = doing<GoingOn>(); now && state_.steps >= now->commit) {
    const bool chosen = now->chosen && begins_at(o);
    if (chosen && state_.path.meets == goal_moves)
      begin_path(brief.reason == PlanReason::kDirectWay ? brief.reason : PlanReason::kQuicker);
    else if (chosen || brief.reason == PlanReason::kArrives)
      begin(GoingDirect{}, brief.reason);
    else
      begin(Stopping{state_.steps + periods(params_.decisions.stop_time), now->direct_time}, brief.reason);
  }
  if (const Stopping* now = doing<Stopping>(); now && (stands || state_.steps >= now->stop_end))
    begin(Choosing{state_.steps, now->direct_time}, brief.reason);
  guides_ = brief.mode != PlanMode::kDirect;
  wanted_.setZero();
  if (Following* now = doing<Following>())
    follow(o, *now);
  else
    state_.rate = 0.0;
  anew_ = std::exchange(state_.clears_detours, false);
  ++state_.steps;
}

void Lookahead::follow(const Observation& o, Following& following) noexcept {
  PlanBrief& brief = state_.brief;
  // A pose that the robot chooses among those of its goal moves with the robot, and a goal in motion by itself.
  shift_ = shift_of_goal(mobile_ && is_whole(o.goal) && !state_.path.meets, state_.path.X_WG, o.goal.X_WG);
  // The path's clock waits for objects that will pass.
  long looks = kWatched;
  const double meet = params_.decisions.meet, wait = params_.decisions.wait;
  const double met = traffic_ ? watch_.met_after(state_.path, shift_, brief.clock, meet, o.objects, looks) : meet;
  const double most_rate = std::clamp((met - wait) / (meet - wait), 0.0, 1.0);
  const FollowStep step =
      follow_path(planner().limits(), params_, state_.path, brief.clock, dt_, most_rate, shift_, o, wanted_);
  brief.lag = step.lag;
  state_.rate = step.rate;
  advance_clock(dt_);
  WholeConfiguration target;
  state_.path.at(brief.clock, target);
  brief.target = shift_.of(target).head<3>();
  place_end();
  if (brief.clock <= following.mark_clock + params_.decisions.progress) return;
  following.mark = state_.steps;
  following.mark_clock = brief.clock;
}

void Lookahead::work(const Observation& o, const EscapeState& escape) noexcept {
  long budget = budget_ - debt_;
  const long whole = budget;
  if (doing<GoingDirect>())
    work_direct(o, escape, budget);
  else if (Following* now = doing<Following>())
    work_path(o, escape, *now, budget);
  else if (doing<SettingOut>())
    work_set_out(o, escape, budget);
  else
    work_choice(o, escape, budget);
  checks_ = whole - budget;
  debt_ = std::max(0L, -budget);
}

// Looks for a direct way, and where none is free predicts the policy, which does not set out if it fails.
void Lookahead::work_set_out(const Observation& o, const EscapeState& escape, long& budget) noexcept {
  const bool late = state_.steps >= periods(params_.decisions.set_out_time);
  if (job_ != Job::kSetOut && job_ != Job::kPredict) {
    choice_.begin_way(o);
    job_ = Job::kSetOut;
  }
  if (job_ == Job::kSetOut) {
    if (choice_.direct_way().advance(budget) && !late) return;
    job_ = Job::kNone;
    if (choice_.direct_way().found()) {
      state_.path = choice_.direct_way().path();
      begin_path(PlanReason::kDirectWay);
      return;
    }
  }
  if (late) return go_direct(PlanReason::kStart, Detours::kKept);
  if (!predict(o, escape, params_.horizon, budget)) return;
  if (rollout_.end() != RolloutEnd::kArrives) return begin(Choosing{state_.steps, -1.0}, PlanReason::kFails);
  go_direct(PlanReason::kStart, Detours::kKept);
  predicted_from_ = state_.steps;  // the policy acts from the next step on
  end_direct_prediction(false);
}

void Lookahead::work_direct(const Observation& o, const EscapeState& escape, long& budget) noexcept {
  const bool stagnated = escape.stagnations > state_.stagnations;
  state_.stagnations = escape.stagnations;
  if (stagnated) {
    stop(PlanReason::kStagnates, -1.0);
    return;
  }
  if (job_ == Job::kNone && state_.steps < state_.next && !news_) return;
  if (!predict(o, escape, params_.horizon, budget)) return;
  end_direct_prediction(in_motion(o.goal));
  if (doing<GoingOn>()) work_choice(o, escape, budget);
}

void Lookahead::work_path(const Observation& o, const EscapeState& escape, Following& following,
                          long& budget) noexcept {
  state_.stagnations = escape.stagnations;
  long looks = std::min(budget, kWatched);
  budget -= looks;
  const bool holds = watch_.holds(state_.path, shift_, state_.brief.clock, o.objects, looks);
  budget += looks;
  if (!holds) {
    stop(PlanReason::kPathBroken, -1.0);
    return;
  }
  Path& path = state_.path;
  if (path.meets) {
    work_meeting(o, budget);
    return;
  }
  if (path.passes() && state_.brief.clock >= path.pass) {
    if (arrived_ || (state_.brief.clock < path.pass + params_.decisions.missed && !stuck())) return;
    // The path leads away from a goal that it has missed.
    state_.missed = following.former = true;
    path.pass = kInfinity;
    job_ = Job::kNone;
  }
  const double rest = path.arrival() - state_.brief.clock;
  if (following.former) {
    if (!work_way(o, kInfinity, following, budget)) go_direct(PlanReason::kStart, Detours::kCleared);
    return;
  }
  if (rest <= 0.0) {
    if (arrived_) {  // it holds the path's end
      following.mark = state_.steps;
      return;
    }
    if (at_end()) {
      state_.held_off = state_.held_off || stuck();
      go_direct(PlanReason::kPathEnds, Detours::kCleared);
      return;
    }
  }
  // Nothing is quicker than a direct way. The policy's rows keep more than a path of little clearance has: another path
  // may be quicker, but for goals close to an object.
  const bool direct = state_.brief.reason == PlanReason::kDirectWay;
  const bool tight = params_.follow.to_end && state_.path.clearance < params_.clearance;
  // Another path to the goal would need a way on from there again.
  const bool late = path.passes() && rest < params_.decisions.pass_rest;
  const bool due = !direct && !(tight && path.close()) && !late && (state_.steps >= state_.next || news_);
  const bool may_go_on = job_ == Job::kNone || job_ == Job::kGoOn || job_ == Job::kPass;
  if (may_go_on && !stuck() && work_onward(o, budget)) return;
  if (job_ == Job::kNone && !due && !stuck()) return;
  if (job_ != Job::kPredict && !path.close() && !stuck() && work_way(o, rest, following, budget)) return;
  // A policy that was predicted to arrive with so little of a path left, and did not, is not believed twice.
  const bool last = rest < params_.decisions.last_part;
  if ((tight || (last && state_.left_last_part)) && !stuck()) {
    state_.next = state_.steps + periods(params_.period);
    news_ = false;
    return;
  }
  const double arrival = rest + params_.settle;
  if (!predict(o, EscapeState{}, std::min(params_.horizon, arrival), budget)) return;
  state_.next = state_.steps + periods(params_.period);
  if (rollout_.end() == RolloutEnd::kArrives && rollout_.time() <= arrival) {
    state_.left_last_part = state_.left_last_part || last;
    go_direct(PlanReason::kArrives, Detours::kCleared);
  } else if (stuck()) {
    stop(PlanReason::kNoProgress, -1.0);
  }
}

// A path to where a goal in motion is expected ends beside it. The policy takes over as soon as it is predicted to
// arrive.
void Lookahead::work_meeting(const Observation& o, long& budget) noexcept {
  if (state_.brief.clock >= state_.path.duration && at_end()) {
    go_direct(PlanReason::kPathEnds, Detours::kCleared);
    return;
  }
  if (stuck()) {
    stop(PlanReason::kNoProgress, -1.0);
    return;
  }
  if (job_ == Job::kNone && state_.steps < state_.next && !news_) return;
  if (!predict(o, EscapeState{}, params_.horizon, budget)) return;
  state_.next = state_.steps + periods(params_.period);
  if (rollout_.end() == RolloutEnd::kArrives) go_direct(PlanReason::kArrives, Detours::kCleared);
}

// Sets the state in which a choice takes effect to where the path has the robot after `ahead` of its clock.
void Lookahead::look_ahead_on_path(const Observation& o, double ahead) noexcept {
  way_from_ = state_.brief.clock + ahead;
  MotionState later;
  state_.path.at(way_from_, later.c);
  state_.path.velocity(way_from_, 0.5 * dt_, later.v);
  later.v *= state_.rate;
  copy_observation(o, later_);
  choice_.put(shift_.of(later), later_);
}

// Makes a choice for where the path has the robot in a moment, between the `rest` of the path and what is quicker, and
// goes over to that. A path to a former goal has no rest that counts, and the first direct way does. True if it goes
// over, or has to work on.
bool Lookahead::work_way(const Observation& o, double rest, const Following& following, long& budget) noexcept {
  PlanBrief& brief = state_.brief;
  const bool former = following.former;
  if (job_ != Job::kSetOut) {
    const double ahead = state_.rate * (former ? params_.decisions.way_ahead : goes_on());
    if (params_.direct == 0 || ahead <= 0.0 || ahead + params_.decisions.way_gain >= rest) return false;
    look_ahead_on_path(o, ahead);
    const double left = former ? -1.0 : rest - ahead - params_.decisions.way_gain;
    choice_.begin(later_, left, former ? brief.attempts : ++brief.attempts, !former);
    job_ = Job::kSetOut;
  }
  const double until = std::max(0.0, way_from_ - brief.clock);
  if (until < static_cast<double>(kHurry) * dt_) choice_.hurry();
  const bool more = choice_.advance(budget);
  if (until > dt_ && (more || !former)) return true;
  job_ = Job::kNone;
  if (more || choice_.verdict().kind != PlanKind::kPath) return false;
  brief.choice = choice_.verdict();
  state_.path = choice_.path();
  state_.path.begin_earlier(until);
  state_.next = state_.steps + periods(params_.period);
  begin_path(choice_.is_direct() ? PlanReason::kDirectWay : PlanReason::kQuicker);
  return true;
}

// Works on a choice while the robot goes on, slows down or stands.
void Lookahead::work_choice(const Observation& o, const EscapeState& escape, long& budget) noexcept {
  std::int64_t end = std::numeric_limits<std::int64_t>::max();
  if (const GoingOn* now = doing<GoingOn>()) {
    state_.stagnations = escape.stagnations;
    if (now->chosen) return;  // it waits to take effect
    end = now->commit;
  }
  const Choosing* stands = doing<Choosing>();
  if (stands) end = stands->stop_end + periods(params_.decisions.choice_time);
  if (job_ != Job::kChoose) {
    if (doing<GoingOn>()) go_direct(state_.brief.reason, Detours::kKept);  // the work in progress was lost
    if (!stands) return;
    choice_.begin(o, stands->direct_time, ++state_.brief.attempts);
    job_ = Job::kChoose;
  }
  if (state_.steps + kHurry >= end) choice_.hurry();
  if (!choice_.advance(budget) || (stands && state_.steps >= end)) choose();
}

// Begins or continues a prediction. True once it has ended.
bool Lookahead::predict(const Observation& o, const EscapeState& escape, double time, long& budget) noexcept {
  if (job_ != Job::kPredict) {
    rollout_.begin(o, escape, prediction_limits(params_, escape_, time));
    predicted_from_ = state_.steps - 1;
    later_time_ = -1.0;
    news_ = false;
    job_ = Job::kPredict;
  }
  while (budget > 0) {
    budget -= Rollout::kChecks;
    const bool ended = rollout_.step() != RolloutEnd::kGoesOn || rollout_.over();
    if (later_time_ < 0.0 && rollout_.time() + 0.5 * rollout_.period() > goes_on()) {
      copy_observation(rollout_.state(), later_);
      later_time_ = rollout_.time();
    }
    if (!ended) continue;
    job_ = Job::kNone;
    return true;
  }
  return false;
}

void Lookahead::end_direct_prediction(bool goal_moves) noexcept {
  const bool arrives = rollout_.end() == RolloutEnd::kArrives;
  const double time = arrives ? rollout_.time() : kInfinity;
  const bool first = state_.next == 0;
  state_.next = state_.steps + periods(params_.period);
  if (time < params_.decisions.soon) return;
  // A goal in motion that the policy pursues without contact is left to it.
  if (goal_moves && !arrives && (rollout_.end() == RolloutEnd::kLate || rollout_.end() == RolloutEnd::kGoesOn))
    begin(GoingDirect{}, PlanReason::kTraffic);
  else if (!arrives)
    go_on(PlanReason::kFails, -1.0);
  else if (state_.held_off)  // the end of a path would hold it again
    begin(GoingDirect{}, PlanReason::kArrives);
  else if (first)
    go_on(PlanReason::kStart, time);
  else
    look_for_way(time);
}

bool Lookahead::stuck() noexcept { return state_.steps - doing<Following>()->mark > periods(params_.stuck); }

bool Lookahead::at_end() noexcept {
  const DecisionParams& decisions = params_.decisions;
  return state_.brief.lag < (state_.path.close() ? decisions.arrived_close : decisions.arrived) || stuck();
}

// If nothing arrives, the direct policy goes on; its memory of detours is cleared if a path was left for the choice.
void Lookahead::choose() noexcept {
  const PlanVerdict& choice = choice_.verdict();
  job_ = Job::kNone;
  state_.next = state_.steps + periods(params_.period);
  if (choice.kind == PlanKind::kPolicy && state_.brief.reason == PlanReason::kArrives) {
    begin(GoingDirect{}, PlanReason::kArrives);
    return;
  }
  state_.brief.choice = choice;
  if (choice.kind == PlanKind::kPolicy) {
    const bool nothing = choice.policy < 0.0;
    if (nothing && planner().close_goal()) state_.next = state_.steps;
    const bool left_path = state_.path.count > 0;
    go_direct(nothing ? PlanReason::kNoPath : PlanReason::kQuicker, left_path ? Detours::kCleared : Detours::kKept);
    return;
  }
  state_.path = choice_.path();
  const PlanReason reason = choice_.is_direct() ? PlanReason::kDirectWay : PlanReason::kQuicker;
  if (GoingOn* now = doing<GoingOn>()) {
    now->chosen = true;
    if (choice_.is_direct()) state_.brief.reason = reason;
  } else {
    begin_path(reason);
    state_.next = state_.steps;  // the first path that a robot at rest has found is rarely a quick one
  }
}

}  // namespace moma
