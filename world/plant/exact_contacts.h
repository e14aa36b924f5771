#pragma once

#include <memory>
#include <vector>

#include "controller/model/proximity.h"
#include "world/plant/plant.h"

namespace moma {

/// True for the shapes whose contact ODE decides without misses: sphere, box and capsule (docs/physics.md).
constexpr bool decided_by_ode(ShapeKind kind) {
  return kind == ShapeKind::kSphere || kind == ShapeKind::kBox || kind == ShapeKind::kCapsule;
}

/// Contacts of every pair in which a cylinder or convex hull takes part, by the distance library.
class ExactContacts {
 public:
  /// Nothing where no such shape occurs.
  static std::unique_ptr<ExactContacts> make(const RobotModel& model, const World& world,
                                             const std::vector<bool>& meets_floor);

  /// Appends the pairs that overlap, with by_ode = false.
  void detect(const Kinematics& kinematics, const std::vector<ObjectState>& states, double time,
              std::vector<Contact>& found);

 private:
  ExactContacts(std::shared_ptr<const RobotModel> model, const World& world, const std::vector<bool>& meets_floor);

  std::shared_ptr<const RobotModel> model_;   // self pairs: the hard ones only
  Proximity proximity_;
  std::vector<bool> hard_shape_, hard_object_, meets_floor_;
  ProximityRanges ranges_;
};

}  // namespace moma
