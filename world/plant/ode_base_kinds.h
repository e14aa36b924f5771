#pragma once

#include <memory>

#include "world/plant/ode_base.h"

namespace moma {

/// The drive of one kind of base: the implementations of OdeBase's two static functions.
struct OdeBaseKind {
  std::unique_ptr<OdeBase> (*make)(dWorldID world, const RobotModel& model, OdeArm& arm, const Vector3& base,
                                   double friction);
  double (*own_mass)(const RobotModel& model);
};

extern const OdeBaseKind kDifferentialBase;
extern const OdeBaseKind kOmnidirectionalBase;

}  // namespace moma
