#include "controller/situation.h"

#include <algorithm>

#include "controller/model/manipulability.h"
#include "controller/step_described.h"

namespace moma {

Assessment::Assessment(std::shared_ptr<const RobotModel> model, const ControllerParams& params)
    : params_(params),
      base_dof_(model->base_dof()),
      prismatic_(model->num_joints()),
      kinematics_(model),
      J_m_(VectorX::Zero(model->num_joints())) {
  aimed_.q = J_m_;
  aimed_.qdot = VectorX::Zero(model->num_velocities());
  for (int i = 0; i < model->num_joints(); ++i) prismatic_[i] = model->joint(i).type == JointType::kPrismatic ? 1 : 0;
}

Situation Assessment::assess(const Observation& seen, std::span<const PlaceSpread> spreads, const Execution& execution,
                             StepClock* clock) noexcept {
  enter(clock, StepPart::kKinematics);
  kinematics_.update(seen.base, seen.q);
  const bool whole = is_whole(seen.goal);
  Task servo;
  if (!whole) {
    copy_observation(seen, aimed_);
    aimed_.goal.X_WG = nearest_pose(seen.goal.X_WG, seen.goal.free, kinematics_.X_WE());
    servo.free = seen.goal.free;
    servo.R_WG = seen.goal.X_WG.linear();
  }
  const Observation& o = whole ? seen : aimed_;
  servo.error = pose_error(kinematics_.X_WE(), o.goal.X_WG);
  const Vector6 error =
      params_.servo.error == ServoError::kRpy ? pose_error_rpy(kinematics_.X_WE(), o.goal.X_WG) : servo.error;
  servo.nu = o.goal.stop ? servo_twist(params_.servo, error, o.goal.V_WG_W)
                         : passing_twist(params_.servo, error, o.goal.V_WG_W);
  servo.raw_error_norm = error_norm(params_.error_norm, servo.error);
  servo.error_norm = std::min(std::max(servo.raw_error_norm, params_.error_norm.min), params_.error_norm.max);
  servo.theta_eps = base_dof_ > 0 ? bearing(kinematics_.X_WB(), kinematics_.X_WE().translation()) : 0.0;
  const auto J_arm = kinematics_.J_WE_W().rightCols(prismatic_.size());
  double value = 0.0;
  if (params_.manipulability.weight != 0.0) {
    value = manipulability_gradient(J_arm, prismatic_, params_.manipulability.rows, J_m_).value;
  } else {
    value = manipulability(J_arm, params_.manipulability.rows);
    J_m_.setZero();
  }
  return {o, spreads, kinematics_, servo, value, J_m_, execution, clock};
}

VectorX Assessment::J_m() const {
  VectorX gradient(prismatic_.size());
  manipulability_gradient(kinematics_.J_WE_W().rightCols(prismatic_.size()), prismatic_, params_.manipulability.rows,
                          gradient);
  return gradient;
}

}  // namespace moma
