#include "world/plant/ode_base.h"

#include <algorithm>

#include "world/plant/ode_base_kinds.h"

namespace moma {

double OdeBase::wheel_mass(const RobotModel& model) {
  // Two wheels of 2 % of the base's mass each, at most 1 kg: light beside the base, not so light as to be stiff.
  return model.base.type == BaseType::kDifferential ? 2.0 * std::min(1.0, 0.02 * model.base.mass) : 0.0;
}

std::unique_ptr<OdeBase> OdeBase::make(dWorldID world, const RobotModel& model, OdeArm& arm, const Vector3& base) {
  switch (model.base.type) {
    case BaseType::kFixed: return nullptr;
    case BaseType::kDifferential: return make_differential_base(world, model, arm, base);
    case BaseType::kOmnidirectional: return make_omnidirectional_base(world, model, arm, base);
  }
  return nullptr;
}

}  // namespace moma
