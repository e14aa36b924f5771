#include "world/plant/cross_check.h"

#include <algorithm>

#include "world/plant/contacts.h"

namespace moma {
namespace {

/// Records which pairs touch according to ODE, in the order of detection.
class TouchedPairs final : public TouchSink {
 public:
  void touch(const Touch& touch) override { pairs_.push_back({touch.kind, touch.first, touch.second}); }
  bool has(PairKind kind, int first, int second) const {
    return std::any_of(pairs_.begin(), pairs_.end(), [&](const Pair& pair) {
      return pair.kind == kind && pair.first == first && pair.second == second;
    });
  }

 private:
  struct Pair {
    PairKind kind;
    int first, second;
  };
  std::vector<Pair> pairs_;
};

}  // namespace

// Needs no hulls: ODE decides spheres, boxes and capsules.
CrossCheck::CrossCheck(const RobotModel& model, const World& world)
    : shapes_(solids_of(model)), objects_(solids_of(world)), coal_(0) {}

void CrossCheck::judge(bool touches, double distance, DetectorCheck& check) {
  const double contradiction = touches ? distance : -distance;
  if (!(contradiction > kTolerance)) return;
  ++check.disagreements;
  check.deepest = std::max(check.deepest, contradiction);
}

void CrossCheck::compare_pair(const Solid& a, dGeomID geom_a, const Solid& b, dGeomID geom_b, bool touches,
                              DetectorCheck& check) {
  const Isometry X_WA = ode::pose(geom_a);
  const Isometry X_WB = ode::pose(geom_b);
  // Solids with disjoint bounding spheres are apart.
  const bool far = (X_WA.translation() - X_WB.translation()).norm() > a.radius + b.radius;
  if (far && !touches) return;
  judge(touches, coal_.distance(a.geometry, X_WA, b.geometry, X_WB).d, check);
}

DetectorCheck CrossCheck::compare(ContactScene& scene) {
  TouchedPairs touched;
  scene.detect(touched);
  DetectorCheck check;
  for (int i = 0; i < static_cast<int>(shapes_.size()); ++i) {
    const dGeomID robot = scene.robot_geom(i);
    if (robot == nullptr) continue;
    const Solid& shape = shapes_[static_cast<std::size_t>(i)];
    for (int k = 0; k < static_cast<int>(objects_.size()); ++k) {
      if (const dGeomID object = scene.object_geom(k))
        compare_pair(shape, robot, objects_[static_cast<std::size_t>(k)], object, touched.has(PairKind::kObject, i, k),
                     check);
    }
    if (scene.meets_floor(i))
      judge(touched.has(PairKind::kFloor, i, -1), lowest_point(shape.shape, ode::pose(robot)), check);
  }
  for (const SelfPair& pair : scene.self_pairs())
    compare_pair(shapes_[static_cast<std::size_t>(pair.first)], scene.robot_geom(pair.first),
                 shapes_[static_cast<std::size_t>(pair.second)], scene.robot_geom(pair.second),
                 touched.has(PairKind::kSelf, pair.first, pair.second), check);
  return check;
}

}  // namespace moma
