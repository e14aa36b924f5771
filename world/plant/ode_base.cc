#include "world/plant/ode_base.h"

#include <cstddef>
#include <iterator>

namespace moma {
namespace {

// In the order of BaseType; null for a fixed base.
constexpr const OdeBaseKind* kKinds[] = {nullptr, &kDifferentialBase, &kOmnidirectionalBase};
static_assert(std::size(kKinds) == words(Of<BaseType>{}).size());

const OdeBaseKind* drive_of(const RobotModel& model) { return kKinds[static_cast<std::size_t>(model.base.type)]; }

}  // namespace

double OdeBase::own_mass(const RobotModel& model) {
  const OdeBaseKind* kind = drive_of(model);
  return kind != nullptr ? kind->own_mass(model) : 0.0;
}

std::unique_ptr<OdeBase> OdeBase::make(dWorldID world, const RobotModel& model, OdeArm& arm, const Vector3& base,
                                       double friction) {
  const OdeBaseKind* kind = drive_of(model);
  return kind != nullptr ? kind->make(world, model, arm, base, friction) : nullptr;
}

}  // namespace moma
