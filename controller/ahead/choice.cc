#include "controller/ahead/choice.h"

#include <algorithm>
#include <cmath>

#include "controller/ahead/candidates.h"

namespace moma {
namespace {

constexpr double kGain = 0.1;       // of a detour over the best so far, at least [s]
constexpr double kStopping = 0.01;  // between two moments of coming to rest [s]
// Plans, each with more work, before detours are looked at: they hardly ever lead to a goal that is close to an object.
constexpr int kPlans = 4;

}  // namespace

double comes_to_rest(const RobotModel& model, const MotionLimits& limits, const Observation& o,
                     WholeConfiguration& c) noexcept {
  const int base = model.base_dof();
  WholeConfiguration v = o.qdot;
  WholeConfiguration q = o.q;
  Vector3 at = o.base;
  double time = 0.0;
  constexpr int kMost = 500;
  for (int k = 0; k < kMost && v.cwiseAbs().maxCoeff() > 0.0; ++k) {
    for (Eigen::Index i = 0; i < v.size(); ++i) {
      const double a = i >= base ? limits.joint_acceleration[i - base]
                                 : (i + 1 == base ? limits.angular_acceleration : limits.linear_acceleration);
      v[i] = std::copysign(std::max(0.0, std::abs(v[i]) - a * kStopping), v[i]);
    }
    integrate(model, at, q, v, kStopping);
    time += kStopping;
  }
  c.resize(3 + q.size());
  c << at, q;
  return time;
}

Choice::Choice(std::shared_ptr<const RobotModel> model, const ControllerParams& params)
    : model_(model),
      params_(params.plan),
      escape_(params.escape),
      planner_(model, params),
      kinematics_(model),
      stand_(WholeConfiguration::Zero(3 + model->num_joints())) {
  candidates_.reserve(2 + kCandidates);
  from_.q = model->ready;
  from_.qdot = VectorX::Zero(model->num_velocities());
}

void Choice::reset(std::span<const ObjectShape> objects) {
  planner_.set_objects(objects);
  from_.objects.assign(objects.size(), ObjectState{});
  candidates_.clear();
  job_ = Job::kDone;
}

void Choice::begin(const Observation& from, double direct_time, int number) noexcept {
  copy_observation(from, from_);
  stopping_ = comes_to_rest(*model_, planner_.limits(), from_, stand_);
  kinematics_.update(from_.base, from_.q);
  candidates_.clear();
  best_ = 0;
  least_ = kInfinity;
  take({.kind = PlanKind::kPolicy, .time = direct_time});
  seed_ = static_cast<std::uint64_t>(number - 1);
  detour_ = params_.detours ? 0 : kCandidates;
  rolling_ = false;
  plans_ = 0;
  begin_plan();
  plans_first_ = number > kTrusted || planner_.close_goal();
  if (!plans_first_) job_ = Job::kDetours;
}

void Choice::take(const PlanCandidate& candidate) noexcept {
  candidates_.push_back(candidate);
  if (candidate.time < 0.0 || candidate.time >= least_) return;
  least_ = candidate.time;
  best_ = candidates_.size() - 1;
}

// No path that takes longer than the best so far is of use.
void Choice::begin_plan() noexcept {
  ++plans_;
  planner_.begin(stand_, from_.goal.X_WG, from_.objects, seed_, least_ - params_.settle - stopping_);
  job_ = Job::kPlan;
}

bool Choice::advance(Rollout& rollout, long& budget) noexcept {
  while (budget > 0 && job_ != Job::kDone) {
    if (job_ == Job::kPlan) {
      if (planner_.advance(budget)) break;
      const bool found = planner_.found();
      if (!found && planner_.close_goal() && plans_ < kPlans) {
        begin_plan();
        continue;
      }
      take({.kind = PlanKind::kPath, .time = found ? stopping_ + planner_.path().duration + params_.settle : -1.0});
      job_ = plans_first_ && !found ? Job::kDetours : Job::kDone;
      continue;
    }
    if (rolling_) {
      roll_out(rollout, budget);
    } else if (detour_ == kCandidates) {
      job_ = Job::kDone;
      if (!plans_first_) begin_plan();
    } else {
      const EscapeState start = candidate(escape_, kinematics_, from_.goal, detour_++);
      rollout.begin(from_, start, prediction_limits(params_, escape_, std::min(params_.horizon, least_ - kGain)));
      rolling_ = true;
    }
  }
  return job_ != Job::kDone;
}

void Choice::roll_out(Rollout& rollout, long& budget) noexcept {
  if (rollout.advance(budget)) return;
  rolling_ = false;
  take({.kind = PlanKind::kDetour,
        .index = detour_ - 1,
        .time = rollout.end() == RolloutEnd::kArrives ? rollout.time() : -1.0,
        .end = rollout.end(),
        .ended = rollout.time()});
}

PlanVerdict Choice::verdict() const noexcept {
  PlanVerdict out;
  out.kind = best().kind;
  out.detour = best().index;
  out.tried = static_cast<int>(candidates_.size());
  for (const PlanCandidate& candidate : candidates_) {
    double& best = candidate.kind == PlanKind::kPolicy   ? out.policy
                   : candidate.kind == PlanKind::kDetour ? out.by_detour
                                                         : out.by_path;
    if (candidate.time >= 0.0 && (best < 0.0 || candidate.time < best)) best = candidate.time;
  }
  return out;
}

EscapeState Choice::start() const noexcept { return candidate(escape_, kinematics_, from_.goal, best().index); }

}  // namespace moma
