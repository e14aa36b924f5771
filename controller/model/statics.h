#pragma once

#include <memory>
#include <vector>

#include "controller/model/kinematics.h"

namespace moma {

/// What the drives have to give so that the arm stands still on an upright base, without contact: per joint,
/// tau_i = g * sum over the links l that it moves of m_l * d z(c_l) / d q_i, with c_l the centre of mass; the gradient
/// of the potential energy (Lynch & Park 2017, 8.1.3, at rest). [Nm], [N] for prismatic joints; size num_joints().
/// Links without inertia in the URDF weigh nothing. `gravity` in m/s^2. O(links * joints).
VectorX holding_efforts(const Kinematics& kinematics, double gravity = 9.81);

/// A joint's holding effort against what its drive has.
struct JointLoad {
  int joint = 0;         ///< index into RobotModel::joints
  double limit = 0.0;    ///< the joint's `effort`
  double ready = 0.0;    ///< size of the holding effort at `ready`
  double largest = 0.0;  ///< the largest met in the range
  VectorX q_largest;     ///< where that is
  double beyond = 0.0;   ///< share of the range's samples that ask for more than `limit`
};

/// For each joint with a known effort, from `ready` and `samples` configurations within the limits (a Halton sequence:
/// the same each time).
std::vector<JointLoad> joint_loads(std::shared_ptr<const RobotModel> model, int samples = 2000);

}  // namespace moma
