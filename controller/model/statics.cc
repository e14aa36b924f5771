#include "controller/model/statics.h"

#include <cmath>

#include "controller/model/sampling.h"

namespace moma {

VectorX holding_efforts(const Kinematics& kinematics, double gravity) {
  const RobotModel& model = kinematics.model();
  VectorX efforts = VectorX::Zero(model.num_joints());
  Matrix3X jacobian(3, model.num_velocities());
  for (std::size_t l = 1; l < model.links.size(); ++l) {
    const Link& link = model.links[l];
    if (!link.inertial || !(link.inertial->mass > 0.0)) continue;
    const int index = static_cast<int>(l);
    kinematics.point_jacobian(index, kinematics.X_WL(index) * link.inertial->com_L, jacobian);
    efforts += link.inertial->mass * gravity * jacobian.row(2).tail(model.num_joints()).transpose();
  }
  return efforts;
}

std::vector<JointLoad> joint_loads(std::shared_ptr<const RobotModel> model, int samples) {
  Kinematics kinematics(model);
  std::vector<JointLoad> loads;
  const VectorX ready = holding_efforts(kinematics);
  for (int i = 0; i < model->num_joints(); ++i) {
    const double limit = model->joint(i).effort;
    if (limit > 0.0) loads.push_back({i, limit, std::abs(ready[i]), std::abs(ready[i]), model->ready, 0.0});
  }
  VectorX q(model->num_joints());
  std::vector<int> beyond(loads.size(), 0);
  for (int s = 1; s <= samples; ++s) {
    for (int i = 0; i < q.size(); ++i) {
      const auto [lower, upper] = drawn_range(model->joint(i));
      q[i] = lower + halton_coordinate(s, i) * (upper - lower);
    }
    kinematics.update(Vector3::Zero(), q);
    const VectorX efforts = holding_efforts(kinematics);
    for (std::size_t k = 0; k < loads.size(); ++k) {
      const double effort = std::abs(efforts[loads[k].joint]);
      beyond[k] += effort > loads[k].limit;
      if (effort <= loads[k].largest) continue;
      loads[k].largest = effort;
      loads[k].q_largest = q;
    }
  }
  for (std::size_t k = 0; k < loads.size(); ++k) loads[k].beyond = static_cast<double>(beyond[k]) / samples;
  return loads;
}

}  // namespace moma
