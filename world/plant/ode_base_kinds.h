#pragma once

#include "world/plant/ode_base.h"

namespace moma {

std::unique_ptr<OdeBase> make_differential_base(dWorldID world, const RobotModel& model, OdeArm& arm,
                                                const Vector3& base, double friction);
std::unique_ptr<OdeBase> make_omnidirectional_base(dWorldID world, const RobotModel& model, OdeArm& arm,
                                                   double friction);

}  // namespace moma
