#include "controller/model/robot_model.h"

#include "controller/model/base_kind.h"

namespace moma {

int RobotModel::base_dof() const noexcept { return kind_of(base.type).dof(); }

int RobotModel::find_link(std::string_view link_name) const noexcept {
  for (std::size_t i = 0; i < links.size(); ++i)
    if (links[i].name == link_name) return static_cast<int>(i);
  return -1;
}

VectorX RobotModel::velocity_limits() const {
  VectorX limits(num_velocities());
  int k = 0;
  for (; k < base_dof() - 1; ++k) limits[k] = base.max_linear;
  if (base_dof() > 0) limits[k++] = base.max_angular;
  for (const ControlledJoint& joint : joints) limits[k++] = joint.velocity;
  return limits;
}

std::vector<std::string> RobotModel::velocity_names() const {
  const BaseKind& kind = kind_of(base.type);
  std::vector<std::string> names(kind.velocities.begin(), kind.velocities.end());
  for (const ControlledJoint& joint : joints) names.push_back(joint.name);
  return names;
}

}  // namespace moma
