#include "controller/qp/limits.h"

#include <algorithm>
#include <cmath>

#include "controller/model/base_kind.h"
#include "controller/model/robot_model.h"
#include "controller/safe/braking.h"

namespace moma {
namespace {

// The command acts one period after the measurement of its state, for one period.
constexpr double kReactionPeriods = 2.0;

// S+ of the article (mirrored: S-): 0 if room < 0, else speed min(room / margin, 1).
double source_bound(double room, double margin, double speed) noexcept {
  return room < 0.0 ? 0.0 : speed * std::min(room / margin, 1.0);
}

// The speed from which a joint stops at rho_s, braking at `deceleration` after `reaction`; eta (rho - rho_s), the way
// back, if room is less than rho_s. With a reaction of at least one control period T a joint that keeps the bound can
// keep it in the next step: v(rho - v T) >= v(rho) - deceleration T.
double braking_bound(double room, const JointLimitParams& params, double part, double deceleration,
                     double reaction) noexcept {
  const double left = room - part * params.stop;
  return left < 0.0 ? params.gain * left : stoppable_speed(left, deceleration, reaction);
}

// eta (rho - rho_s)/(rho_i - rho_s) inside rho_i, infinity outside (Haviland & Corke, arXiv 2002.11901, eq. 19). A
// `part` below 1 (limit_part()) shortens rho_i and rho_s at the same slope.
double damper_bound(double room, const JointLimitParams& params, double part) noexcept {
  if (!(room < part * params.influence)) return kInfinity;
  return params.gain * (room - part * params.stop) / (params.influence - params.stop);
}

}  // namespace

VelocityBounds::VelocityBounds(const RobotModel& model, const ControllerParams& params, double control_period)
    : base_dof_(model.base_dof()),
      law_(params.joint_limits),
      speed_(model.velocity_limits()),
      q_lower_(model.num_joints()),
      q_upper_(model.num_joints()),
      margin_(resolve_margin(model, params.joint_limits.margin)),
      part_(model.num_joints()),
      step_(params.acceleration_limit * control_period),
      deceleration_(params.joint_limits.share * params.acceleration_limit.tail(model.num_joints())),
      period_(control_period),
      hard_base_(params.base_share > 0.0 && base_dof_ > 0),
      hard_joints_(params.joint_limits.method == JointLimitMethod::kBraking),
      pair_(hard_base_ && kind_of(model.base.type).lateral()) {
  for (int i = 0; i < model.num_joints(); ++i) {
    q_lower_[i] = model.joint(i).lower;
    q_upper_[i] = model.joint(i).upper;
    part_[i] = limit_part(model.joint(i));
  }
  for (int i = 0; i + 1 < base_dof_; ++i) speed_[i] = bounded_speed(model, params);
  for (int i = 0; i < model.num_velocities(); ++i)
    if (!(i < base_dof_ ? hard_base_ : hard_joints_) && std::isfinite(params.acceleration_limit[i]))
      has_soft_acceleration_ = true;
}

void Bounds::allocate(int num_velocities) {
  lower = upper = hard_lower = hard_upper = VectorX::Zero(num_velocities);
  pair = {};
}

void Bounds::hold_base(int base_dof, const Vector3& velocity) noexcept {
  for (int i = 0; i < base_dof; ++i) {
    const double held = std::min(std::max(velocity[i], lower[i]), upper[i]);
    lower[i] = upper[i] = hard_lower[i] = hard_upper[i] = held;
  }
}

void VelocityBounds::bound(const VectorX& q, const VectorX& qdot, double hold, Bounds& out) const noexcept {
  joint_limits(q, out.hard_lower, out.hard_upper, hold);
  acceleration(qdot, out.hard_lower, out.hard_upper, out.lower, out.upper);
  out.pair = linear_pair(qdot);
  // The drives' limits hold in every stage of the fallback.
  const Eigen::Index joints = out.lower.size() - base_dof_;
  if (hard_base_) {
    out.hard_lower.head(base_dof_) = out.lower.head(base_dof_);
    out.hard_upper.head(base_dof_) = out.upper.head(base_dof_);
  }
  if (hard_joints_) {
    out.hard_lower.tail(joints) = out.lower.tail(joints);
    out.hard_upper.tail(joints) = out.upper.tail(joints);
  }
}

void VelocityBounds::brake(const VectorX& q, const VectorX& qdot, Bounds& work, VectorX& command) const noexcept {
  const bool measured = qdot.size() == speed_.size();
  work.hard_lower = -speed_;
  work.hard_upper = speed_;
  if (q.size() == q_lower_.size()) joint_limits(q, work.hard_lower, work.hard_upper);
  work.lower = work.hard_lower;
  work.upper = work.hard_upper;
  if (measured) acceleration(qdot, work.hard_lower, work.hard_upper, work.lower, work.upper);
  for (Eigen::Index i = 0; i < command.size(); ++i) {
    const bool known = measured && std::isfinite(qdot[i]);
    command[i] = known ? braking(work.lower[i], work.upper[i]) : braking(work.hard_lower[i], work.hard_upper[i]);
  }
  work.pair = measured && qdot.allFinite() ? linear_pair(qdot) : LinearPair{};
  if (work.pair.on) smallest_command(work.lower.head(2), work.upper.head(2), work.pair, command.head(2));
}

void VelocityBounds::joint_limits(const Eigen::Ref<const VectorX>& q, Eigen::Ref<VectorX> lower,
                                  Eigen::Ref<VectorX> upper, double hold) const noexcept {
  // The velocity can change once in `hold` periods, by the limit of one period.
  const double reaction = (kReactionPeriods - 1.0 + hold) * period_;
  for (int i = 0; i < base_dof_; ++i) {
    lower[i] = -speed_[i];
    upper[i] = speed_[i];
  }
  for (int i = 0; i < static_cast<int>(q.size()); ++i) {
    const int v = base_dof_ + i;
    const double speed = speed_[v];
    const auto bound = [&](double room) {
      switch (law_.method) {
        case JointLimitMethod::kNone:
          break;
        case JointLimitMethod::kSource:
          return source_bound(room, margin_[i], speed);
        case JointLimitMethod::kDamper:
          return damper_bound(room, law_, part_[i]);
        case JointLimitMethod::kBraking:
          return braking_bound(room, law_, part_[i], deceleration_[i] / hold, reaction);
      }
      return speed;
    };
    // An infinite limit (a continuous joint, or one open on a side) gives infinite room and no bound.
    double low = -bound(q[i] - q_lower_[i]), high = bound(q_upper_[i] - q[i]);
    if (low > high) low = high = 0.5 * (low + high);
    lower[v] = std::min(std::max(low, -speed), speed);
    upper[v] = std::min(std::max(high, -speed), speed);
  }
}

void VelocityBounds::acceleration(const VectorX& qdot, const Eigen::Ref<const VectorX>& hard_lower,
                                  const Eigen::Ref<const VectorX>& hard_upper, Eigen::Ref<VectorX> lower,
                                  Eigen::Ref<VectorX> upper) const noexcept {
  for (int i = 0; i < static_cast<int>(step_.size()); ++i) {
    const double slowest = qdot[i] - step_[i], fastest = qdot[i] + step_[i];
    if (hard_joints_ && i >= base_dof_) {
      const double most = speed_[i];
      lower[i] = std::clamp(std::clamp(hard_lower[i], slowest, fastest), -most, most);
      upper[i] = std::clamp(std::clamp(hard_upper[i], slowest, fastest), -most, most);
    } else {
      lower[i] = std::min(std::max(slowest, hard_lower[i]), hard_upper[i]);
      upper[i] = std::min(std::max(fastest, hard_lower[i]), hard_upper[i]);
    }
  }
}

double sight_speed(const SightParams& sight, const RobotModel& model, double deceleration) noexcept {
  const double room = sight.range - sight.reach - sight.speed * sight.reaction;
  const double reaction = sight.reaction + (std::isinf(deceleration) ? 0.0 : sight.speed / deceleration);
  return std::min(model.base.max_linear, stoppable_speed(room, deceleration, reaction));
}

double bounded_speed(const RobotModel& model, const ControllerParams& params) noexcept {
  const double fastest = model.base.max_linear;
  if (!params.sight.enabled || model.base_dof() == 0) return fastest;
  // Each of two linear velocities has its share.
  const double part = std::sqrt(1.0 / kind_of(model.base.type).num_linear());
  return std::min(fastest, part * sight_speed(params.sight, model, params.acceleration_limit[0]));
}

LinearPair VelocityBounds::linear_pair(const VectorX& qdot) const noexcept {
  if (!pair_) return {};
  // The measured velocity may exceed the limit.
  const Vector2 most = speed_.head<2>();
  return {true, qdot.head<2>().cwiseMax(-most).cwiseMin(most), step_[0]};
}

double braking(double lower, double upper) noexcept {
  const double value = std::min(std::max(0.0, lower), upper);
  return std::isfinite(value) && lower <= upper ? value : 0.0;
}

void smallest_command(const Eigen::Ref<const VectorX>& lower, const Eigen::Ref<const VectorX>& upper,
                      const LinearPair& pair, Eigen::Ref<VectorX> out) noexcept {
  for (Eigen::Index i = 0; i < out.size(); ++i) out[i] = braking(lower[i], upper[i]);
  if (!pair.on) return;
  const double speed = pair.velocity.norm();
  out.head<2>() = speed > pair.step ? Vector2((1.0 - pair.step / speed) * pair.velocity) : Vector2(0.0, 0.0);
}

void add_drive_rows(const LinearPair& pair, QpProblem& problem) noexcept {
  if (!pair.on) return;
  constexpr double kHalf = 0.70710678118654752;
  for (int i = 0; i < 2; ++i) {
    const double y = i == 0 ? kHalf : -kHalf;
    const double now = kHalf * pair.velocity.x() + y * pair.velocity.y();
    problem.append({RowKind::kDrive, i, -1}, now - pair.step, now + pair.step, Vector2(kHalf, y));
  }
}

VectorX resolve_margin(const RobotModel& model, const JointMargin& given) {
  if (!given.automatic) return given.value;
  VectorX margin(model.num_joints());
  for (int i = 0; i < model.num_joints(); ++i) {
    const ControlledJoint& joint = model.joint(i);
    margin[i] = std::min(0.3, 0.25 * (joint.upper - joint.lower));
  }
  return margin;
}

void add_wheel_rows(const MobileBase& base, QpProblem& problem) noexcept {
  const int wheels = num_wheels(base);
  const BaseKind& kind = kind_of(base.type);
  for (int i = 0; i < wheels; ++i) {
    const Vector3 map = kind.wheel_row(*base.wheels, i);
    problem.append({RowKind::kWheel, i, -1}, -base.wheels->max_speed, base.wheels->max_speed, map.head(kind.dof()));
  }
}

}  // namespace moma
