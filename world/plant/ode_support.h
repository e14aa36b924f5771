#pragma once

#include <ode/ode.h>

#include <vector>

#include "controller/model/robot_model.h"
#include "world/plant/ode_arm.h"

namespace moma {

/// ODE's ERP, the part of a constraint's error that a step of h seconds takes away: errors fade with 9 ms, whatever the
/// step. (0.2 at 2 ms, 0.67 at 10 ms.)
double error_reduction(double h);

/// Frictionless spheres under the base that carry it: casters of a differential drive, or the rolling contacts of
/// mecanum wheels, whose friction is in their drive.
class OdeSupport {
 public:
  /// @param points where they touch the floor, in B.
  /// @param stiffness of their contacts [N/m]. Casters' is 1e8: stiff, but much softer than the wheels, so that the
  /// wheels carry the weight and casters only what would tip the base.
  OdeSupport(const OdeArm& arm, const std::vector<Vector2>& points, double radius, double stiffness);

  /// For a step of h seconds.
  void add_contacts(dWorldID world, dJointGroupID group, double h);

  /// Four points under the base's outline, as far out as they fit: `at_ends` keeps them at its front and rear, and
  /// draws in their sides (beside the wheels of a differential drive); otherwise they come in along the diagonals.
  static std::vector<Vector2> corners(const RobotModel& model, double radius, bool at_ends);

 private:
  ode::Space space_;
  std::vector<dGeomID> spheres_;
  dGeomID floor_ = nullptr;
  double stiffness_;
};

}  // namespace moma
