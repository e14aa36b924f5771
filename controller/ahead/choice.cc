#include "controller/ahead/choice.h"

#include <algorithm>
#include <cmath>

#include "controller/ahead/rollout.h"

namespace moma {
namespace {

constexpr double kStopping = 0.01;  // between two moments of coming to rest [s]

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
      settle_(params.plan.settle),
      close_plans_(params.plan.decisions.close_plans),
      planner_(model, params),
      stand_(WholeConfiguration::Zero(3 + model->num_joints())) {
  from_.q = model->ready;
  from_.qdot = VectorX::Zero(model->num_velocities());
}

void Choice::reset(std::span<const ObjectShape> objects) {
  planner_.set_objects(objects);
  from_.objects.assign(objects.size(), ObjectState{});
  done_ = true;
}

void Choice::begin(const Observation& from, double direct_time, int number) noexcept {
  copy_observation(from, from_);
  stopping_ = comes_to_rest(*model_, planner_.limits(), from_, stand_);
  verdict_ = {.kind = PlanKind::kPolicy, .tried = 1, .policy = direct_time};
  seed_ = static_cast<std::uint64_t>(number - 1);
  plans_ = 0;
  begin_plan();
}

// A path that takes longer than the policy is useless.
void Choice::begin_plan() noexcept {
  ++plans_;
  const double most = verdict_.policy >= 0.0 ? verdict_.policy : kInfinity;
  planner_.begin(stand_, from_.goal.X_WG, from_.objects, seed_, most - settle_ - stopping_);
  done_ = false;
}

bool Choice::advance(long& budget) noexcept {
  while (budget > 0 && !done_) {
    if (planner_.advance(budget)) break;
    if (!planner_.found() && planner_.close_goal() && plans_ < close_plans_) {
      begin_plan();
      continue;
    }
    done_ = true;
    ++verdict_.tried;
    if (!planner_.found()) continue;
    verdict_.by_path = stopping_ + planner_.path().duration + settle_;
    if (verdict_.policy < 0.0 || verdict_.by_path < verdict_.policy) verdict_.kind = PlanKind::kPath;
  }
  return !done_;
}

}  // namespace moma
