#pragma once

#include <ode/ode.h>

#include <vector>

#include "controller/model/convex_distance.h"
#include "world/plant/plant.h"
#include "world/plant/solid.h"

namespace moma {

class ContactScene;

/// Asks the distance library (coal) about every pair that ODE decides, in the poses of ODE's own geoms, and counts
/// where the two contradict each other. The floor is asked for by the lowest point of a shape.
class CrossCheck {
 public:
  /// Distances of coal are good to 2e-6 m; a contradiction is one of more than this [m].
  static constexpr double kTolerance = 1e-5;

  CrossCheck(const RobotModel& model, const World& world);

  /// Of the state in which the scene is; changes nothing in it.
  DetectorCheck compare(ContactScene& scene);

 private:
  static void judge(bool touches, double distance, DetectorCheck& check);
  void compare_pair(const Solid& a, dGeomID geom_a, const Solid& b, dGeomID geom_b, bool touches, DetectorCheck& check);

  std::vector<Solid> shapes_, objects_;
  ConvexDistance coal_;
};

}  // namespace moma
