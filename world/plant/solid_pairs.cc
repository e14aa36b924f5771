#include "world/plant/solid_pairs.h"

#include <algorithm>

namespace moma {
namespace {

// If a bound exceeds the range by less than this, computing the exact distance pays [m].
constexpr double kWorthIt = 0.05;

}  // namespace

std::vector<SolidPair> solid_pairs(const RobotModel& model, std::size_t objects, const std::vector<bool>& meets_floor) {
  std::vector<SolidPair> pairs;
  for (int i = 0; i < static_cast<int>(model.shapes.size()); ++i) {
    for (int k = 0; k < static_cast<int>(objects); ++k) pairs.push_back({PairKind::kObject, i, k});
    if (!meets_floor.empty() && meets_floor[static_cast<std::size_t>(i)]) pairs.push_back({PairKind::kFloor, i, -1});
  }
  for (const SelfPair& pair : model.self_pairs) pairs.push_back({PairKind::kSelf, pair.first, pair.second});
  return pairs;
}

PairGaps::PairGaps(const RobotModel& model, const World& world)
    : shapes_(solids_of(model)),
      objects_(solids_of(world)),
      convex_(std::max(most_vertices(shapes_), most_vertices(objects_))) {}

PairGaps::Gap PairGaps::gap(const SolidPair& pair, const Kinematics& kinematics, std::span<const ObjectState> objects,
                            double range) {
  const std::vector<CollisionShape>& shapes = kinematics.model().shapes;
  const auto i = static_cast<std::size_t>(pair.first);
  const Solid& a = shapes_[i];
  const Isometry X_WA = kinematics.X_WS(shapes[i]);
  if (pair.kind == PairKind::kFloor) return {lowest_point(a.shape, X_WA), true};
  const auto k = static_cast<std::size_t>(pair.second);
  const bool self = pair.kind == PairKind::kSelf;
  const Solid& b = self ? shapes_[k] : objects_[k];
  const Isometry X_WB = self ? kinematics.X_WS(shapes[k]) : objects[k].X_WO;
  const bool far = apart(a, X_WA, b, X_WB, range);
  if (far) {
    const double least = least_gap(a, X_WA, b, X_WB);
    if (!(least <= range + kWorthIt)) return {least, false};  // also false if a pose is not finite
  }
  return {signed_distance(a, X_WA, b, X_WB, convex_).d, !far};
}

}  // namespace moma
