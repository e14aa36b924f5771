#include "controller/lookahead/rollout.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "controller/safe/pose_track.h"
#include "controller/step_described.h"

namespace moma {
namespace {

// The model has neither latency nor uncertainty. Its longer period asks for fewer periods between checked moments.
ControllerParams on_time(ControllerParams params) {
  params.prediction.enabled = false;
  params.map.enabled = false;  // its boxes are among the objects
  params.uncertainty.enabled = false;
  params.collision.evasion.enabled = false;  // a base that drives away does not arrive
  params.collision.check.every = std::max(1, params.collision.check.every / 2);
  return params;
}

// Time from `error` to `tolerance`, at `speed` at most and no quicker than exponentially.
double least_time(double error, double gain, double speed, double tolerance) noexcept {
  if (error <= tolerance) return 0.0;
  const double slow = std::max(speed / gain, tolerance);
  return std::max(0.0, error - slow) / speed + std::log(std::min(error, slow) / tolerance) / gain;
}

// Rows and slack may move E quicker than the servo asks.
constexpr double kSooner = 0.9;

}  // namespace

RolloutLimits prediction_limits(const PlanParams& plan, const EscapeParams& escape, double time) noexcept {
  const double part = plan.decisions.tolerance;
  return {time, plan.touch, part * escape.position, part * escape.orientation, true, true};
}

double least_time(const ServoParams& servo, const Vector6& error, const RolloutLimits& limits) noexcept {
  return std::max(least_time(error.tail<3>().norm(), servo.position, servo.max_linear, limits.position),
                  least_time(error.head<3>().norm(), servo.orientation, servo.max_angular, limits.orientation));
}

Rollout::Rollout(std::shared_ptr<const RobotModel> model, ControllerParams params, double period)
    : model_(model), period_(period), policy_(std::move(model), on_time(std::move(params)), period) {
  policy_.prepare(result_);
  reset({});
}

void Rollout::reset(std::span<const ObjectShape> objects) {
  policy_.reset(objects);
  state_.q = model_->ready;
  state_.qdot = VectorX::Zero(model_->num_velocities());
  state_.objects.assign(objects.size(), ObjectState{});
  end_ = RolloutEnd::kGoesOn;
  time_ = 0.0;
}

void Rollout::begin(const Observation& o, const EscapeState& escape, const RolloutLimits& limits) noexcept {
  limits_ = limits;
  copy_observation(o, state_);
  for (ObjectState& object : state_.objects)
    if (!object.seen) object.visible = false;  // as plans, it goes through space that no sensor has seen
  policy_.set_escape_state(escape);
  allowed_ = escape.stagnations + (escape.idle >= policy_.params().escape.patience ? 1 : 0);
  time_ = 0.0;
  end_ = RolloutEnd::kGoesOn;
}

RolloutEnd Rollout::step() noexcept {
  if (end_ != RolloutEnd::kGoesOn) return end_;
  policy_.step(state_, result_);
  if (result_.error.tail<3>().norm() < limits_.position && result_.error.head<3>().norm() < limits_.orientation)
    return end_ = RolloutEnd::kArrives;
  const std::optional<Upright>& upright = state_.upright;
  if (upright && policy_.params().upright.enabled && tilt(*upright, policy_.kinematics()) > upright->angle)
    return end_ = RolloutEnd::kTouches;
  // The hand may be nearer to the object that it grasps.
  if (result_.least_distance < std::min(limits_.touch, 0.5 * policy_.kept_stop())) return end_ = RolloutEnd::kTouches;
  if (limits_.stagnation_ends && policy_.escape_state().stagnations > allowed_) return end_ = RolloutEnd::kStagnates;
  if (limits_.late_ends && time_ + kSooner * least_time(policy_.params().servo, result_.error, limits_) > limits_.time)
    return end_ = RolloutEnd::kLate;
  const int base = model_->base_dof();
  for (int i = 0; i < base; ++i) {
    const double most = period_ * model_->base.max_acceleration[i + 1 == base ? 1 : 0];
    result_.command[i] = std::clamp(result_.command[i], state_.qdot[i] - most, state_.qdot[i] + most);
  }
  integrate(*model_, state_.base, state_.q, result_.command, period_);
  state_.qdot = result_.command;
  for (ObjectState& object : state_.objects) moma::advance(object.V_WO_W, period_, object.X_WO);
  moma::advance(state_.goal.V_WG_W, period_, state_.goal.X_WG);
  time_ += period_;
  state_.time += period_;
  return end_;
}

bool Rollout::advance(long& budget) noexcept {
  while (budget > 0) {
    budget -= kChecks;
    if (step() != RolloutEnd::kGoesOn || over()) return false;
  }
  return true;
}

}  // namespace moma
