#include "world/plant/ode_base.h"

#include <algorithm>
#include <vector>

#include "world/plant/ode_base_kinds.h"

namespace moma {

double OdeBase::wheel_mass(const RobotModel& model) {
  if (model.base.type != BaseType::kDifferential) return 0.0;
  double base_mass = model.base.mass;
  if (!(base_mass > 0.0)) {  // then the links that are rigid with the base carry it
    std::vector<bool> rigid(model.links.size(), true);
    for (std::size_t i = 1; i < model.links.size(); ++i) {
      const Link& link = model.links[i];
      rigid[i] = rigid[static_cast<std::size_t>(link.parent)] && link.controlled < 0;
      if (rigid[i] && link.inertial) base_mass += link.inertial->mass;
    }
  }
  // Two wheels of 2 % of the base's mass each, at most 1 kg: light beside the base, not so light as to be stiff.
  return 2.0 * std::min(1.0, 0.02 * base_mass);
}

std::unique_ptr<OdeBase> OdeBase::make(dWorldID world, const RobotModel& model, OdeArm& arm, const Vector3& base,
                                       double friction) {
  switch (model.base.type) {
    case BaseType::kFixed:
      return nullptr;
    case BaseType::kDifferential:
      return make_differential_base(world, model, arm, base, friction);
    case BaseType::kOmnidirectional:
      return make_omnidirectional_base(world, model, arm, friction);
  }
  return nullptr;
}

}  // namespace moma
