#include "controller/closed_form/closed_form.h"

namespace moma {
namespace {

constexpr double kInfluence = 0.9;  // [rad, m]
constexpr double kStop = 0.05;

double repulsion(double room) noexcept {
  if (!(room < kInfluence)) return 0.0;
  const double ratio = (room - kInfluence) / (kStop - kInfluence);
  return ratio * ratio;
}

}  // namespace

void add_limit_repulsion(const RobotModel& model, const VectorX& q, VectorX& gradient) noexcept {
  const int base_dof = model.base_dof();
  for (int i = 0; i < model.num_joints(); ++i) {
    const ControlledJoint& joint = model.joints[static_cast<std::size_t>(i)];
    gradient[base_dof + i] += repulsion(q[i] - joint.lower) - repulsion(joint.upper - q[i]);
  }
}

}  // namespace moma
