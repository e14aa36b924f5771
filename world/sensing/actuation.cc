#include "world/sensing/actuation.h"

namespace moma {

Actuation::Actuation(const Disturbances& disturbances, const RobotModel& model, const World& world,
                     double control_period)
    : base_dof_(model.base_dof()),
      factor_(VectorX::Ones(model.num_velocities())),
      base_(VectorX::Zero(base_dof_)),
      joints_(VectorX::Zero(model.num_joints())),
      applied_(VectorX::Zero(model.num_velocities())),
      late_base_(delay_steps(disturbances.actuators.base.delay, control_period), base_, BeforeFirst::kPrototype),
      late_joints_(delay_steps(disturbances.actuators.joints.delay, control_period), joints_, BeforeFirst::kPrototype) {
  using enum DisturbanceSource;
  const Actuators& errors = disturbances.actuators;
  const DisturbanceStreams streams(world, disturbances.seed);
  Draws linear = streams.acting(kBaseLinearGain);
  for (int i = 0; i + 1 < base_dof_; ++i) factor_[i] += linear.normal(0.0, errors.base.gain_error.linear);
  if (base_dof_ > 0)
    factor_[base_dof_ - 1] += streams.acting(kBaseAngularGain).normal(0.0, errors.base.gain_error.angular);
  Draws joints = streams.acting(kJointGain);
  for (Eigen::Index i = base_dof_; i < factor_.size(); ++i) factor_[i] += joints.normal(0.0, errors.joints.gain_error);
  factor_ = factor_.cwiseMax(0.0);
}

const VectorX& Actuation::act(long k, const VectorX& command) {
  base_ = command.head(base_dof_);
  joints_ = command.tail(joints_.size());
  late_base_.pass(k, base_);
  late_joints_.pass(k, joints_);
  applied_.head(base_dof_) = base_;
  applied_.tail(joints_.size()) = joints_;
  applied_.array() *= factor_.array();
  return applied_;
}

}  // namespace moma
