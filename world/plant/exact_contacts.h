#pragma once

#include <memory>
#include <vector>

#include "controller/model/proximity.h"
#include "world/plant/plant.h"

namespace moma {

/// True for shapes whose contacts ODE decides without misses: sphere, box and capsule (docs/explanation/physics.md).
constexpr bool decided_by_ode(ShapeKind kind) {
  return kind == ShapeKind::kSphere || kind == ShapeKind::kBox || kind == ShapeKind::kCapsule;
}

/// Contacts of every pair with a cylinder or convex hull, by the distance library.
class ExactContacts {
 public:
  /// Null if no such shape occurs.
  static std::unique_ptr<ExactContacts> make(const RobotModel& model, const World& world,
                                             const std::vector<bool>& meets_floor);

  /// Appends the overlapping pairs, with by_ode = false.
  void detect(const Kinematics& kinematics, const std::vector<ObjectState>& states, double time,
              std::vector<Contact>& found);

 private:
  ExactContacts(std::shared_ptr<const RobotModel> model, const World& world, const std::vector<bool>& meets_floor);
  /// True if a pair touches: by the sign of its distance or, near zero, by a common point.
  bool overlaps(const ProximityPair& pair, const Kinematics& kinematics, const std::vector<ObjectState>& states) const;

  std::shared_ptr<const RobotModel> model_;  // only self pairs that ODE does not decide
  Proximity proximity_;
  std::vector<Shape> objects_;
  std::vector<bool> hard_shape_, hard_object_, meets_floor_;
};

}  // namespace moma
