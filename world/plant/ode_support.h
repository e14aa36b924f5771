#pragma once

#include <ode/ode.h>

#include <vector>

#include "controller/model/robot_model.h"
#include "world/plant/ode_arm.h"

namespace moma {

/// Frictionless spheres under the base that carry it: casters of a differential drive, or the rolling contacts of
/// mecanum wheels, whose friction is in their drive.
class OdeSupport {
 public:
  /// @param points where they touch the floor, in B.
  /// @param cfm softness of their contacts; 1e-6 is 1e8 N/m at 2 ms: stiff, but much softer than the wheels, so
  /// that the wheels carry the weight and casters only what would tip the base.
  OdeSupport(const OdeArm& arm, const std::vector<Vector2>& points, double radius, double cfm);

  void add_contacts(dWorldID world, dJointGroupID group);

  /// Four points under the base's outline, as far out as they fit: `at_ends` keeps them at its front and rear, and
  /// draws in their sides (beside the wheels of a differential drive); otherwise they come in along the diagonals.
  static std::vector<Vector2> corners(const RobotModel& model, double radius, bool at_ends);

 private:
  ode::Space space_;
  std::vector<dGeomID> spheres_;
  dGeomID floor_ = nullptr;
  double cfm_;
};

}  // namespace moma
