#include "controller/task/escape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace moma {
namespace {

constexpr double kShort = 0.02;  // a shorter horizontal vector has no direction [m]

// Speed at which a goal with this twist recedes: its own contribution to V. An arm may wait for a goal that comes, a
// base that stands is held: `mobile` counts its coming too, as negative.
double receding(const EscapeParams& params, bool mobile, const Vector6& error, const Vector6& V_WG_W) noexcept {
  const auto along = [mobile](const Vector3& e, const Vector3& v) {
    const double length = e.norm(), speed = length > 0.0 ? e.dot(v) / length : 0.0;
    return mobile ? speed : std::max(0.0, speed);
  };
  return along(error.tail<3>(), V_WG_W.tail<3>()) + params.scale * along(error.head<3>(), V_WG_W.head<3>());
}

// Sum of the distances from joint to joint, from the robot's root to its end effector.
double arm_length(const RobotModel& model) noexcept {
  double length = model.X_TE.translation().norm();
  for (int link = model.tip; link > 1; link = model.link(link).parent)
    length += model.link(link).X_PJ.translation().norm();
  return length;
}

}  // namespace

double remaining_way(const EscapeParams& params, const Vector6& error) noexcept {
  return error.tail<3>().norm() + params.scale * error.head<3>().norm();
}

Vector3 heading(const Vector3& v, const Vector3& otherwise) noexcept {
  const double length = std::hypot(v.x(), v.y());
  return length < kShort ? otherwise : Vector3(v.x() / length, v.y() / length, 0.0);
}

int free_side(std::span<const ProximityPair> pairs, const Vector3& e_h, double reach) noexcept {
  Vector3 a = Vector3::Zero();
  for (const ProximityPair& pair : pairs) {
    if (pair.kind == PairKind::kObject) a += std::clamp(1.0 - pair.distance.d / reach, 0.0, 1.0) * pair.distance.n_W;
  }
  return e_h.x() * a.y() - e_h.y() * a.x() >= 0.0 ? 1 : -1;
}

Escape::Escape(const EscapeParams& params, const ServoParams& servo, const RobotModel& model, double control_period)
    : params_(params), servo_(servo), dt_(control_period), mobile_(model.base_dof() > 0) {
  max_length_ = mobile_ ? params.max_length : std::min(params.max_length, 0.5 * arm_length(model));
}

void Escape::reset() noexcept { set_state({}); }

void Escape::set_memory(const EscapeMemory& memory) noexcept {
  state_ = memory.state;
  last_goal_ = memory.last_goal;
  has_goal_ = memory.has_goal;
}

bool Escape::goal_jumped(const GoalState& goal) const noexcept {
  const Vector3 expected = last_goal_.X_WG.translation() + dt_ * last_goal_.V_WG_W.tail<3>();
  const double turned = log_so3(goal.X_WG.linear() * last_goal_.X_WG.linear().transpose()).norm();
  return (goal.X_WG.translation() - expected).norm() > params_.jump ||
         turned > params_.jump_angle + dt_ * last_goal_.V_WG_W.head<3>().norm();
}

void Escape::update(const EscapeInput& input, Task& task) noexcept {
  if (!params_.enabled) return;
  if (has_goal_ && goal_jumped(input.goal)) reset();
  last_goal_ = input.goal;
  has_goal_ = true;
  const double V = remaining_way(params_, task.error);
  if (state_.detour) {
    state_.remaining -= dt_;
    const Vector3 left = state_.target_W - input.kinematics.X_WE().translation();
    if (state_.remaining <= 0.0 || std::hypot(left.x(), left.y()) < params_.reached) {
      state_.detour = false;
      state_.best = V;
      state_.idle = 0.0;
    }
  }
  if (!state_.detour) watch(input, task, V);
  if (state_.detour) bend(input, task);
}

void Escape::watch(const EscapeInput& input, const Task& task, double V) noexcept {
  const bool settled =
      task.error.tail<3>().norm() < params_.position && task.error.head<3>().norm() < params_.orientation;
  if (state_.best < 0.0 || settled || V < state_.best - params_.progress) {
    state_.best = V;
    state_.idle = 0.0;
    return;
  }
  state_.best = std::max(0.0, state_.best + dt_ * receding(params_, mobile_, task.error, input.goal.V_WG_W));
  state_.idle += dt_;
  if (state_.idle >= params_.patience) stagnate(input, task, V);
}

void Escape::stagnate(const EscapeInput& input, const Task& task, double V) noexcept {
  const Vector3 forward = input.kinematics.X_WB().linear().col(0);
  const Vector3 e_h = heading(task.error.tail<3>(), forward);
  if (state_.side == 0) state_.side = free_side(input.pairs, e_h, params_.side_distance);
  const int n = state_.stagnations++;
  state_.best = V;
  state_.idle = 0.0;
  const double growth = 1.0 + params_.growth * n;
  const double turns[] = {params_.angle * state_.side, -params_.angle * state_.side, std::numbers::pi};
  const double alpha = turns[n % 3];
  const double length = std::min(params_.length * growth, max_length_);
  const Vector3 p_WE = input.kinematics.X_WE().translation();
  const Vector3 from = input.kinematics.X_WL(mobile_ ? 0 : 1).translation();
  state_.target_W = from + length * (Eigen::AngleAxisd(alpha, Vector3::UnitZ()) * e_h);
  state_.target_W.z() = p_WE.z();
  state_.remaining = params_.duration * growth;
  state_.detour = true;
}

void Escape::bend(const EscapeInput& input, Task& task) const noexcept {
  Vector6 error = Vector6::Zero();
  error.tail<3>() = state_.target_W - input.kinematics.X_WE().translation();
  task.nu.tail<3>() = servo_twist(servo_, error, Vector6::Zero()).tail<3>();
  task.slack_scale.head<3>().setConstant(params_.slack_factor);
  task.detour = true;
}

}  // namespace moma
