#include "controller/policy/policy.h"

#include <algorithm>

#include "controller/closed_form/closed_form.h"
#include "controller/lookahead/lookahead.h"
#include "controller/model/base_kind.h"
#include "controller/task/escape.h"
#include "controller/task/servo.h"

namespace moma {
namespace {

// The servo's task for the QP. After stagnation a detour changes the task (task/escape.h).
class ServoPolicy final : public Policy {
 public:
  explicit ServoPolicy(const PolicyParts& parts) : parts_(parts) {}

  Demand decide(const Situation& now) noexcept override { return aim(now, parts_.poser.look(now)); }

  QpTask aim(const Situation& now, const Near& near) noexcept {
    enter(now.clock, StepPart::kRows);
    QpTask asked{.task = now.servo};
    parts_.escape.update({now.kinematics, now.o.goal, near.pairs}, asked.task);
    return asked;
  }

 private:
  PolicyParts parts_;
};

// Looking ahead (lookahead/lookahead.h): the velocities of a path while the robot follows one, the servo otherwise.
class PathPolicy final : public Policy {
 public:
  explicit PathPolicy(const PolicyParts& parts) : parts_(parts), servo_(parts) {}

  Demand decide(const Situation& now) noexcept override {
    const Near near = parts_.poser.look(now);
    enter(now.clock, StepPart::kAhead);
    Lookahead& ahead = *parts_.lookahead;
    const BaseRamp::Shares& drive = now.execution.drive;
    ahead.decide(now.o, now.servo.error, now.servo.R_WG, std::min(drive.speeding, drive.slowing), now.execution.missed);
    if (ahead.begins_anew()) parts_.escape.reset();
    begun_with_ = parts_.escape.state();
    if (!ahead.guides()) return servo_.aim(now, near);

    // Tracking gives way to the path's velocities. Rows and bounds hold as ever, except for the dampers of joint
    // limits: a path keeps its own distance.
    constexpr double kSlack = 1e-4;
    const VectorX& velocities = ahead.velocities();
    const double weight = parts_.params.plan.weight;
    QpTask asked{.task = now.servo,
                 .pull = QpTask::Pull{&velocities, weight, weight},
                 .bounds = &ahead.bounds(),
                 .keeps = ahead.keeps(),
                 .passes = ahead.passes()};
    asked.task.nu.setZero();
    const Matrix6X& J = now.kinematics.J_WE_W();
    for (Eigen::Index i = 0; i < velocities.size(); ++i) asked.task.nu += velocities[i] * J.col(i);
    asked.task.slack_scale.setConstant(kSlack);
    return asked;
  }

  void finish(const Situation& now) noexcept override {
    enter(now.clock, StepPart::kAhead);
    parts_.lookahead->work(now.o, begun_with_);
  }

 private:
  PolicyParts parts_;
  ServoPolicy servo_;
  EscapeState begun_with_;  // state of the detours at the start of the step
};

// Separate motion (task/servo.h): the base drives while the arm rests, then the arm moves while the base stands or
// brakes. A driving base ignores distances.
class BaseFirstPolicy final : public Policy {
 public:
  explicit BaseFirstPolicy(const PolicyParts& parts)
      : parts_(parts), servo_(parts), command_(VectorX::Zero(parts.model->num_velocities())) {
    bounds_.allocate(parts.model->num_velocities());
  }

  Demand decide(const Situation& now) noexcept override {
    const MobileBase& base = parts_.model->base;
    const DriveIntoReach drive =
        drive_into_reach(parts_.params.base_first, base, now.o.base, now.o.goal.X_WG.translation());
    if (!drive.driving) {
      QpTask asked = servo_.aim(now, parts_.poser.look(now));
      asked.base = Vector3::Zero();
      return asked;
    }
    const VelocityBounds& limits = parts_.poser.limits();
    limits.bound(now.o.q, now.o.qdot, now.execution.hold, bounds_);
    command_.setZero();
    kind_of(base.type).set_coordinates(drive.velocity_B, command_);
    command_ = command_.cwiseMax(bounds_.lower).cwiseMin(bounds_.upper);
    scale_into_limits(*parts_.model, limits.speed(), command_);
    return DirectCommand{command_};
  }

 private:
  PolicyParts parts_;
  ServoPolicy servo_;
  Bounds bounds_;
  VectorX command_;
};

// Methods without a QP: rrmc, park and baur (closed_form/closed_form.h). They ignore obstacles and joint limits.
class ClosedFormPolicy final : public Policy {
 public:
  explicit ClosedFormPolicy(const PolicyParts& parts)
      : parts_(parts),
        gradient_(VectorX::Zero(parts.model->num_velocities())),
        scratch_(gradient_),
        command_(gradient_) {}

  Demand decide(const Situation& now) noexcept override {
    enter(now.clock, StepPart::kSolve);
    const Matrix6X& J = now.kinematics.J_WE_W();
    if (J.allFinite() && now.servo.nu.allFinite() && now.J_m.allFinite()) {
      follow(now, J);
      if (command_.allFinite()) {
        if (parts_.params.closed_form.scaled) scale_into_limits(*parts_.model, parts_.poser.limits().speed(), command_);
        return DirectCommand{command_};
      }
    }
    command_.setZero();
    return DirectCommand{command_, StepStatus::kInvalidInput};
  }

 private:
  void follow(const Situation& now, const Matrix6X& J) noexcept {
    const ControllerParams& params = parts_.params;
    inverse_.update(J, params.closed_form.damping);
    inverse_.apply(J, now.servo.nu, command_);
    if (params.method == Method::kRrmc) return;
    park_gradient(params, parts_.model->base_dof(), now.J_m, gradient_);
    if (params.method == Method::kBaur) add_limit_repulsion(*parts_.model, now.o.q, gradient_);
    add_projected(inverse_, J, gradient_, scratch_, command_);
  }

  PolicyParts parts_;
  DampedInverse inverse_;
  VectorX gradient_, scratch_, command_;
};

}  // namespace

std::unique_ptr<Policy> make_policy(const PolicyParts& parts) {
  if (parts.params.method != Method::kQp) return std::make_unique<ClosedFormPolicy>(parts);
  if (parts.lookahead != nullptr) return std::make_unique<PathPolicy>(parts);
  if (parts.params.base_first.enabled && parts.model->base_dof() > 0) return std::make_unique<BaseFirstPolicy>(parts);
  return std::make_unique<ServoPolicy>(parts);
}

}  // namespace moma
