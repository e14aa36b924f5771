#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "world/plant/reach_watch.h"

namespace moma {

/// The least distances of a trial, exactly: of the robot to objects, and of those of its own shapes to each other
/// that have rows. Asks only for the distances of pairs that may have come nearer than the least so far.
class ClearanceWatch {
 public:
  ClearanceWatch(const std::shared_ptr<const RobotModel>& model, const World& world);

  /// Looks at a state, which is finite: kinematics are of it, objects are where they are then, not where they were
  /// before only if `objects_move`.
  void look(const Kinematics& kinematics, std::span<const ObjectState> objects, bool objects_move);

  double to_objects() const { return to_objects_; }  ///< [m]; NaN where nothing was measured
  double to_itself() const { return to_itself_; }    ///< [m]; NaN where nothing was measured

 private:
  PairGaps gaps_;
  ReachWatch watch_;
  ReachWatch::Travel travel_;
  bool looked_ = false;
  Vector3 base_ = Vector3::Zero();  // when it looked last
  VectorX q_;
  std::vector<Isometry> X_WO_;
  double to_objects_ = std::numeric_limits<double>::quiet_NaN();
  double to_itself_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace moma
