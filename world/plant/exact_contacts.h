#pragma once

#include <memory>
#include <vector>

#include "controller/model/proximity.h"
#include "world/plant/plant.h"

namespace moma {

/// True for the shapes whose contact ODE decides without misses: sphere, box and capsule (docs/explanation/physics.md).
constexpr bool decided_by_ode(ShapeKind kind) {
  return kind == ShapeKind::kSphere || kind == ShapeKind::kBox || kind == ShapeKind::kCapsule;
}

/// Contacts of every pair in which a cylinder or convex hull takes part, by the distance library.
class ExactContacts {
 public:
  /// Nothing where no such shape occurs.
  static std::unique_ptr<ExactContacts> make(const RobotModel& model, const World& world,
                                             const std::vector<bool>& meets_floor);

  /// Appends the pairs that overlap, with by_ode = false. Where nothing can have moved as far as the least gap found
  /// before, no distance is computed: the answer is the same, for hulls at a fraction of the cost.
  void detect(const Kinematics& kinematics, const std::vector<ObjectState>& states, double time,
              std::vector<Contact>& found);

 private:
  ExactContacts(std::shared_ptr<const RobotModel> model, const World& world, const std::vector<bool>& meets_floor);
  /// Whether a pair touches: by the sign of its distance, and where that is next to nothing by a point that both
  /// contain.
  bool overlaps(const ProximityPair& pair, const Kinematics& kinematics, const std::vector<ObjectState>& states) const;

  std::shared_ptr<const RobotModel> model_;  // self pairs: the hard ones only
  Proximity proximity_;
  std::vector<Shape> objects_;
  std::vector<bool> hard_shape_, hard_object_, meets_floor_;
  ProximityRanges ranges_;

  // State of the last full look: where everything was, and the least gap.
  double motion_since(const Kinematics& kinematics, const std::vector<ObjectState>& states) const;
  void remember(const Kinematics& kinematics, const std::vector<ObjectState>& states, double gap);
  std::vector<double> radii_, object_radii_;
  std::vector<Isometry, Eigen::aligned_allocator<Isometry>> X_WS_, X_WO_;
  double gap_ = -1.0;
};

}  // namespace moma
