#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "controller/model/convex_distance.h"
#include "world/world.h"

namespace moma {

inline std::vector<Solid> solids_of(const RobotModel& model) {
  std::vector<Solid> out;
  for (const CollisionShape& shape : model.shapes) out.emplace_back(shape.shape);
  return out;
}

inline std::vector<Solid> solids_of(const World& world) {
  std::vector<Solid> out;
  for (const WorldObject& object : world.objects) out.emplace_back(object.shape);
  return out;
}

/// Number of vertices of the largest hull.
inline int most_vertices(const std::vector<Solid>& solids) {
  std::size_t most = 0;
  for (const Solid& solid : solids)
    if (solid.shape.hull) most = std::max(most, solid.shape.hull->vertices.size());
  return static_cast<int>(most);
}

/// Two solids that may touch: a robot shape `first` and an object, the floor (-1) or another robot shape, as in
/// Contact.
struct SolidPair {
  PairKind kind;
  int first, second;
};

/// Returns every shape with every object, and those of `meets_floor` (one entry per shape; empty: none) with the floor,
/// shape by shape; then the model's self-collision pairs.
std::vector<SolidPair> solid_pairs(const RobotModel& model, std::size_t objects, const std::vector<bool>& meets_floor);

/// Upper bound of the displacement of a solid's points between two poses: that of the centre plus, at the radius of a
/// ball about the origin that contains the solid, that of the rotation.
inline double moved(const Isometry& from, const Isometry& to, double radius) {
  return (to.translation() - from.translation()).norm() + radius * (to.linear() - from.linear()).norm();
}

/// Distances of single pairs. Owns the geometry: one per worker.
class PairGaps {
 public:
  PairGaps(const RobotModel& model, const World& world);

  struct Gap {
    double least;   ///< lower bound of the signed distance, usually exact [m]
    bool in_range;  ///< `least` is exact, and Proximity::query() includes the pair at this range
  };
  /// Does not allocate. The distance has the bits of Proximity::query().
  Gap gap(const SolidPair& pair, const Kinematics& kinematics, std::span<const ObjectState> objects, double range);

  double object_radius(std::size_t object) const { return objects_[object].radius; }

 private:
  std::vector<Solid> shapes_, objects_;
  ConvexDistance convex_;
};

}  // namespace moma
