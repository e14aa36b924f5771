#pragma once

#include "world/plant/ode_base.h"

namespace moma {

std::unique_ptr<OdeBase> make_differential_base(dWorldID world, const RobotModel& model, OdeArm& arm,
                                                const Vector3& base);
std::unique_ptr<OdeBase> make_omnidirectional_base(dWorldID world, const RobotModel& model, OdeArm& arm,
                                                   const Vector3& base);

}  // namespace moma
