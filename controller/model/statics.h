#pragma once

#include <memory>
#include <vector>

#include "controller/model/kinematics.h"

namespace moma {

/// Efforts of the drives that hold the arm at rest on an upright base, without contact: per joint, tau_i = g * sum over
/// the links l that it moves of m_l * d z(c_l) / d q_i, with c_l the centre of mass; the gradient of the potential
/// energy (Lynch & Park 2017, 8.1.3, at rest). [Nm], [N] for prismatic joints; size num_joints(). Links without inertia
/// in the URDF weigh nothing. `gravity` in m/s^2. O(links * joints).
VectorX holding_efforts(const Kinematics& kinematics, double gravity = 9.81);

/// A joint's holding effort compared with its drive's limit.
struct JointLoad {
  int joint = 0;         ///< index into RobotModel::joints
  double limit = 0.0;    ///< the joint's `effort`
  double ready = 0.0;    ///< magnitude of the holding effort at `ready`
  double largest = 0.0;  ///< the largest over the samples
  VectorX q_largest;     ///< configuration of the largest
  double beyond = 0.0;   ///< share of the range's samples above `limit`
};

/// For each joint with a known effort, from `ready` and `samples` configurations within the limits (a Halton sequence:
/// the same each time).
std::vector<JointLoad> joint_loads(std::shared_ptr<const RobotModel> model, int samples = 2000);

}  // namespace moma
