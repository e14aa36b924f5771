#pragma once

#include <memory>
#include <vector>

#include "world/plant/solid_pairs.h"

namespace moma {

/// Which pairs of solids may be nearer to each other than some range, told for certain from how far base and joints
/// have moved: a pair whose gap was measured once cannot have closed it before its two solids have travelled that far
/// together. A joint carries no point of a solid farther than the angle that it turns by times the greatest distance
/// that the solid can have from its axis, its lever, wherever the joints in between are; two solids of the robot are
/// moved against each other by the joints between them alone.
///
/// Unlike GapWatch it asks for no poses. Both ends of a motion are enough where no coordinate goes farther in between.
/// Gaps are good to 0.1 mm: that much is added to each range. Does not allocate after construction.
class ReachWatch {
 public:
  /// How far things go at most, seen from where a motion begins.
  struct Travel {
    double base = 0.0;  ///< the base's frame [m]
    double turn = 0.0;  ///< the base about its axis [rad]
    VectorX joints;     ///< each joint [rad or m]
    VectorX objects;    ///< the farthest point of each object [m]
  };

  /// Pairs as solid_pairs() has them, or some of them.
  ReachWatch(const std::shared_ptr<const RobotModel>& model, const std::vector<SolidPair>& pairs, std::size_t objects);

  /// Where nothing moves; of the right sizes.
  Travel rest() const;
  /// Sets what the robot moves by between two configurations. Infinite for a linear joint that lies beyond its limits
  /// by more than 1 cm, where there are no levers.
  void between(const Vector3& base_0, const VectorX& q_0, const Vector3& base_1, const VectorX& q_1,
               Travel& travel) const;

  /// What comes now begins where the last motion ended and goes no farther than this.
  void begin(const Travel& travel);
  /// The motion has been made.
  void end();

  /// The pairs that may be nearer than their range at some time of the motion. Where that is not known
  /// gap(pair) -> double is asked how far two solids are apart where the motion begins, or at least are.
  /// Valid until the next call.
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
  // Distances are good to some 1e-5 m, and so are ODE's contacts [m].
  static constexpr double kUncertain = 1e-4;

  // Ways are counted in one list: shapes in the world and in height, self-collision pairs, objects, and one that is 0.
  struct Watched {
    SolidPair pair;
    std::size_t way_first, way_second;
    double until;  // gap, as if it had been measured before any way was made
  };

  static double range_of(PairKind kind, const ProximityRanges& ranges) {
    return kind == PairKind::kObject ? ranges.object : kind == PairKind::kFloor ? ranges.floor : ranges.self;
  }
  void forget();

  std::vector<Watched> pairs_;
  std::vector<SolidPair> near_;
  std::vector<int> linear_;     // joints with a range that levers depend on
  VectorX lower_, upper_;       // of all joints
  MatrixX levers_;              // of the ways but for objects; columns: base, turn, joints
  VectorX moves_, way_, step_;  // as columns of the levers; of each way: made, of the motion that comes
};

}  // namespace moma
