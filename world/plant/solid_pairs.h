#pragma once

#include <span>
#include <vector>

#include "world/plant/solid.h"

namespace moma {

/// Two solids that may meet: a robot shape `first` and an object, the floor (-1) or another robot shape, as in Contact.
struct SolidPair {
  PairKind kind;
  int first, second;
};

/// Every shape with every object, those of `meets_floor` (of each shape; empty: none) with the floor, shape by shape;
/// then the model's self-collision pairs.
std::vector<SolidPair> solid_pairs(const RobotModel& model, std::size_t objects, const std::vector<bool>& meets_floor);

/// No point of a solid with a ball of this radius about its origin has moved farther from one pose to another than
/// its centre and, at that radius, its rotation together.
inline double moved(const Isometry& from, const Isometry& to, double radius) {
  return (to.translation() - from.translation()).norm() + radius * (to.linear() - from.linear()).norm();
}

/// Distances of single pairs, asked for one by one. Owns the geometry: one per worker.
class PairGaps {
 public:
  PairGaps(const RobotModel& model, const World& world);

  struct Gap {
    double least;   ///< the signed distance is no less than this [m]; most often it is this
    bool in_range;  ///< `least` is the distance, and Proximity::query() looks at the pair with this range
  };
  /// Does not allocate. The distance has the bits of Proximity::query().
  Gap gap(const SolidPair& pair, const Kinematics& kinematics, std::span<const ObjectState> objects, double range);

  double object_radius(std::size_t object) const { return objects_[object].radius; }

 private:
  std::vector<Solid> shapes_, objects_;
  ConvexDistance convex_;
};

}  // namespace moma
