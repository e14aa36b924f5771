#pragma once

#include <memory>
#include <vector>

#include "world/plant/solid_pairs.h"

namespace moma {

/// Broad phase: finds pairs of solids that may be nearer than some range, from the motion of base and joints alone. A
/// measured gap stays open until its two solids have travelled that far together. A joint moves no point of a solid
/// farther than its angle times the solid's lever, the greatest distance of the solid from the joint's axis for any
/// position of the joints in between. Only the joints between two solids of the robot move them against each other.
///
/// Unlike GapWatch it needs no poses. Both ends of a motion suffice if no coordinate goes farther in between. Gaps have
/// errors up to 0.1 mm, which is added to each range. Does not allocate after construction.
class ReachWatch {
 public:
  /// Upper bounds of motion, from the start of a motion.
  struct Travel {
    double base = 0.0;  ///< translation of the base's frame [m]
    double turn = 0.0;  ///< rotation of the base about its axis [rad]
    VectorX joints;     ///< each joint [rad or m]
    VectorX objects;    ///< largest displacement of a point of each object [m]
  };

  /// All pairs of solid_pairs(), or some of them.
  ReachWatch(const std::shared_ptr<const RobotModel>& model, const std::vector<SolidPair>& pairs, std::size_t objects);

  /// Returns zero motion of the right sizes.
  Travel rest() const;
  /// Sets the robot's motion between two configurations. Infinite for a linear joint that is beyond its limits by more
  /// than 1 cm, where levers are undefined.
  void between(const Vector3& base_0, const VectorX& q_0, const Vector3& base_1, const VectorX& q_1,
               Travel& travel) const;

  /// Starts a motion at the end of the last one, with these bounds.
  void begin(const Travel& travel);
  void end();

  /// Returns the pairs that may be nearer than their range at some time of the motion. If necessary, calls gap(pair) ->
  /// double for a pair's distance, or a lower bound of it, at the start of the motion. Valid until the next call.
  template <class Gap>
  const std::vector<SolidPair>& within(const ProximityRanges& ranges, Gap&& gap) {
    near_.clear();
    for (Watched& watched : pairs_) {
      const double range = kUncertain + range_of(watched.pair.kind, ranges);
      const double before = way_[watched.way_first] + way_[watched.way_second];
      const double step = step_[watched.way_first] + step_[watched.way_second];
      if (watched.until - before - step > range) continue;
      watched.until = before + gap(watched.pair);
      if (!(watched.until - before - step > range)) near_.push_back(watched.pair);
    }
    return near_;
  }

 private:
  // Errors of distances and of ODE's contacts are about 1e-5 m [m].
  static constexpr double kUncertain = 1e-4;

  // Travel is counted in one list: shapes in the world and in height, self-collision pairs, objects, and a constant 0.
  struct Watched {
    SolidPair pair;
    std::size_t way_first, way_second;
    double until;  // gap plus the travel at the time of its measurement
  };

  static double range_of(PairKind kind, const ProximityRanges& ranges) {
    return kind == PairKind::kObject ? ranges.object : kind == PairKind::kFloor ? ranges.floor : ranges.self;
  }
  void forget();

  std::vector<Watched> pairs_;
  std::vector<SolidPair> near_;
  std::vector<int> linear_;     // joints with a range on which levers depend
  VectorX lower_, upper_;       // of all joints
  MatrixX levers_;              // of all travels except objects; columns: base, turn, joints
  VectorX moves_, way_, step_;  // motion as columns of the levers; travel so far, and of the coming motion
};

}  // namespace moma
