#pragma once

#include <vector>

#include "world/plant/solid_pairs.h"

namespace moma {

/// Where a robot's solids are in one state.
struct SolidPoses {
  std::vector<Isometry> X_WS;            ///< of each shape
  Isometry X_WB = Isometry::Identity();  ///< what self-collision moves against: the base
};

/// Tells for certain that nothing touched anything between two states, without asking for distances at each: a pair
/// whose gap was measured once cannot have closed before its two solids have travelled that far together. The way that
/// a solid can have travelled is its centre's and, at its radius, its rotation's. Pairs are the robot's shapes against
/// objects (in the world), the floor (in height) and each other (in the base's frame).
///
/// A distance (coal) is asked for when a pair's room is used up, and nothing is said to be clear within 0.1 mm.
/// Does not allocate after start().
class GapWatch {
 public:
  /// Self-collision pairs are the model's; `meets_floor`: of each shape.
  GapWatch(const RobotModel& model, const World& world, const std::vector<bool>& meets_floor);

  /// Begins anew at a state.
  void start(const SolidPoses& poses, const std::vector<ObjectState>& objects);

  /// Whether nothing can have touched on the way from the last state to this one, which lasts less than half a turn of
  /// any solid. True: this is the last state from now on. False: it may have; nothing changes.
  bool moves_clear(const SolidPoses& poses, const std::vector<ObjectState>& objects);

 private:
  // Ways are counted in one list: shapes in the world, in height and in the base's frame, objects, and one that is 0.
  struct Pair {
    PairKind kind;
    int first, second;
    std::size_t way_first, way_second;
    double room;  // sum of the two ways at which the pair might touch [m]
  };
  struct Room {
    std::size_t pair;
    double room;
  };

  void add(const SolidPair& pair);
  void note(const SolidPoses& poses, const std::vector<ObjectState>& objects);
  void measure_steps(const SolidPoses& poses, const std::vector<ObjectState>& objects);
  double gap(const Pair& pair, const SolidPoses& poses, const std::vector<ObjectState>& objects);

  std::vector<Solid> shapes_, objects_;
  ConvexDistance coal_;
  std::vector<Pair> pairs_;
  std::vector<Room> found_;
  std::vector<double> way_, step_;  // [m] since start(); of the last state to the one asked about
  SolidPoses last_;
  std::vector<Isometry> last_X_BS_, last_X_WO_;
};

}  // namespace moma
