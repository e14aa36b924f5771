#include "controller/guard/guard.h"

#include <algorithm>

#include "controller/qp/limits.h"
#include "controller/safe/brake_check.h"
#include "controller/safe/evasion.h"

namespace moma {
namespace {

// If no admissible command avoids a moving object (safe/evasion.h), the base starts an evasive motion. The arm follows
// the base as far as its rows allow.
class EvasionGuard final : public Guard {
 public:
  EvasionGuard(const std::shared_ptr<const RobotModel>& model, const ControllerParams& p, double control_period)
      : base_dof_(model->base_dof()),
        evasion_(model, p.collision.evasion, p.acceleration_limit, p.base_share, bounded_speed(*model, p),
                 control_period),
        base_(VectorX::Zero(model->num_velocities())) {}

  void set_objects(std::span<const ObjectShape> objects) override { evasion_.set_objects(objects); }

  Verdict judge(const Situation& now, const Posed& posed, const VectorX& command) noexcept override {
    evasion_.set_shares(now.execution.drive);
    if (evasion_.passes(now.o, command, base_)) return Passes{};
    constexpr double kSlack = 1e-4, kWeight = 1.0;  // E follows the base; joints have no wanted velocity
    QpTask asked{.task = now.servo,
                 .pull = QpTask::Pull{nullptr, 0.0, kWeight},
                 .bounds = posed.asked.bounds,
                 .base = Vector3::Zero(),
                 .keeps = posed.asked.keeps,
                 .evades = true};
    asked.task.nu.setZero();
    for (int i = 0; i < base_dof_; ++i) {
      (*asked.base)[i] = std::min(std::max(base_[i], posed.bounds.lower[i]), posed.bounds.upper[i]);
      asked.task.nu += (*asked.base)[i] * now.kinematics.J_WE_W().col(i);
    }
    asked.task.slack_scale.setConstant(kSlack);
    return asked;
  }

 private:
  int base_dof_;
  Evasion evasion_;
  VectorX base_;  // velocities of the evasion, as far as the base reaches them
};

// Scales a command down whose backup trajectory comes too near to an object at rest (safe/brake_check.h).
class BrakeGuard final : public Guard {
 public:
  BrakeGuard(const std::shared_ptr<const RobotModel>& model, const ControllerParams& p, double control_period)
      : check_(model, p.collision.check, p.acceleration_limit, p.base_share > 0.0, control_period,
               {p.uncertainty, model->base_dof()},
               own_margins(p.collision.floor, p.collision.self, p.collision.check.own)),
        dt_(control_period),
        margin_(p.collision.check.margin),
        stop_(p.collision.object.stop),
        slowest_(VectorX::Zero(model->num_velocities())),
        command_(slowest_) {
    check_.keep_from_unseen(p.map.unseen.margin);
  }

  void set_objects(std::span<const ObjectShape> objects) override { check_.set_objects(objects); }

  Verdict judge(const Situation& now, const Posed& posed, const VectorX& command) noexcept override {
    const Bounds& bounds = posed.bounds;
    smallest_command(bounds.lower, bounds.upper, bounds.pair, slowest_);
    command_ = command;
    check_.set_margin(margin_ * (posed.stop < stop_ ? posed.stop / stop_ : 1.0));
    check_.set_execution(now.execution.hold * dt_, now.execution.drive);
    const double kept = check_.apply(now.o, {bounds.hard_lower, bounds.hard_upper, slowest_}, now.spreads, command_,
                                     {posed.near.pairs, posed.near.ranges, &now.kinematics});
    if (kept == 1.0) return Passes{};
    return Slowed{command_, kept};
  }

 private:
  BrakeCheck check_;
  double dt_;
  double margin_, stop_;  // configured; near the goal both shrink by the same factor [m]
  VectorX slowest_, command_;
};

}  // namespace

std::vector<std::unique_ptr<Guard>> make_guards(const std::shared_ptr<const RobotModel>& model,
                                                const ControllerParams& params, double control_period) {
  std::vector<std::unique_ptr<Guard>> guards;
  if (params.collision.evasion.enabled) guards.push_back(std::make_unique<EvasionGuard>(model, params, control_period));
  if (params.collision.check.enabled) guards.push_back(std::make_unique<BrakeGuard>(model, params, control_period));
  return guards;
}

}  // namespace moma
