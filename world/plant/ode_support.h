#pragma once

#include <ode/ode.h>

#include <vector>

#include "controller/model/robot_model.h"
#include "world/plant/ode_arm.h"

namespace moma {

/// Returns ODE's ERP, the share of a constraint's error that a step of h seconds removes: errors decay with a time
/// constant of 9 ms for any step (0.2 at 2 ms, 0.67 at 10 ms).
double error_reduction(double h);

/// Frictionless spheres that carry the base: casters of a differential drive, or the rolling contacts of mecanum
/// wheels, whose friction is in their drive.
class OdeSupport {
 public:
  /// @param points contact points on the floor, in B. @param stiffness of their contacts [N/m]. That of casters is 1e8:
  /// stiff, but much softer than the wheels, so that the wheels carry the weight and casters prevent tipping.
  OdeSupport(const OdeArm& arm, const std::vector<Vector2>& points, double radius, double stiffness);

  /// Adds the contacts for a step of h seconds.
  void add_contacts(dWorldID world, dJointGroupID group, double h);

  /// Returns four points under the base's outline, as far out as they fit. `at_ends` puts them at its front and rear
  /// and moves them inwards from the sides (beside the wheels of a differential drive); otherwise they move inwards
  /// along the diagonals.
  static std::vector<Vector2> corners(const RobotModel& model, double radius, bool at_ends);

 private:
  ode::Space space_;
  std::vector<dGeomID> spheres_;
  dGeomID floor_ = nullptr;
  double stiffness_;
};

}  // namespace moma
