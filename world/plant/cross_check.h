#pragma once

#include <ode/ode.h>

#include <vector>

#include "controller/model/convex_distance.h"
#include "world/plant/plant.h"
#include "world/plant/solid.h"

namespace moma {

class ContactScene;

/// Compares ODE with the distance library (coal) on every pair that ODE decides, in the poses of ODE's own geoms, and
/// counts contradictions. The lowest point of a shape decides about the floor.
class CrossCheck {
 public:
  /// Smallest contradiction that counts [m]; coal's distances have errors up to 2e-6 m.
  static constexpr double kTolerance = 1e-5;

  CrossCheck(const RobotModel& model, const World& world);

  /// Compares the detectors in the scene's present state, without changing it.
  DetectorCheck compare(ContactScene& scene);

 private:
  static void judge(bool touches, double distance, DetectorCheck& check);
  void compare_pair(const Solid& a, dGeomID geom_a, const Solid& b, dGeomID geom_b, bool touches, DetectorCheck& check);

  std::vector<Solid> shapes_, objects_;
  ConvexDistance coal_;
};

}  // namespace moma
