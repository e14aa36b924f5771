#pragma once

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

/// Upper bound of the displacement of a solid's points between two poses: that of the centre plus, at the radius of a
/// ball about the origin that contains the solid, that of the rotation.
inline double moved(const Isometry& from, const Isometry& to, double radius) {
  return (to.translation() - from.translation()).norm() + radius * (to.linear() - from.linear()).norm();
}

/// Poses of a robot's solids in one state.
struct SolidPoses {
  std::vector<Isometry> X_WS;            ///< of each shape
  Isometry X_WB = Isometry::Identity();  ///< frame of reference for self-collision: the base
};

/// Proves that no pair touched between two states, without distances in each state (continuous collision detection by
/// travel bounds). A measured gap stays open until its two solids have travelled that far together. A solid's travel is
/// bounded by its centre's plus, at its radius, its rotation's. Pairs are the robot's shapes against objects (in the
/// world), the floor (in height) and each other (in the base's frame).
///
/// When travel uses up a pair's gap, coal measures its distance. Gaps within 0.1 mm never count as clear. Does not
/// allocate after start().
class GapWatch {
 public:
  /// Self-collision pairs are the model's; `meets_floor` has an entry for each shape.
  GapWatch(const RobotModel& model, const World& world, const std::vector<bool>& meets_floor);

  void start(const SolidPoses& poses, const std::vector<ObjectState>& objects);

  /// True if no pair can have touched between the last state and this one, which then becomes the last state. False if
  /// one may have touched; nothing changes. No solid may turn by half a revolution in between. `bend`: bound on the
  /// deviation of the shapes' paths from straight lines where that may exceed 0.1 mm [m].
  bool moves_clear(const SolidPoses& poses, const std::vector<ObjectState>& objects, double bend = 0.0);

 private:
  // Travel is counted in one list: shapes in the world, in height and in the base's frame, objects, and a constant 0.
  struct Pair {
    PairKind kind;
    int first, second;
    std::size_t way_first, way_second;
    double room;  // sum of the two travels at which the pair might touch [m]
  };
  struct Room {
    std::size_t pair;
    double room;
  };

  void note(const SolidPoses& poses, const std::vector<ObjectState>& objects);
  void measure_steps(const SolidPoses& poses, const std::vector<ObjectState>& objects, double bend);
  double gap(const Pair& pair, const SolidPoses& poses, const std::vector<ObjectState>& objects);

  std::vector<Solid> shapes_, objects_;
  ConvexDistance coal_;
  std::vector<Pair> pairs_;
  std::vector<Room> found_;
  std::vector<double> way_, step_;  // [m] since start(); from the last state to the present query
  SolidPoses last_;
  std::vector<Isometry> last_X_BS_, last_X_WO_;
};

}  // namespace moma
