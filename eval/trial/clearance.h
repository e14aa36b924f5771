#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "world/plant/reach_watch.h"

namespace moma {

/// The exact least distances of a trial: of the robot to objects, and of its own shapes to each other, for pairs that
/// have rows. The broad phase asks only for pairs that may be nearer than the least distance so far.
class ClearanceWatch {
 public:
  ClearanceWatch(const std::shared_ptr<const RobotModel>& model, const World& world);

  /// Updates the distances for a finite state with its `kinematics` and the objects' states. `objects_move`: objects
  /// may have moved since the last call.
  void look(const Kinematics& kinematics, std::span<const ObjectState> objects, bool objects_move);

  double to_objects() const { return to_objects_; }  ///< [m]; NaN without a measurement
  double to_itself() const { return to_itself_; }    ///< [m]; NaN without a measurement

 private:
  PairGaps gaps_;
  ReachWatch watch_;
  ReachWatch::Travel travel_;
  bool looked_ = false;
  Vector3 base_ = Vector3::Zero();  // base pose of the last call
  VectorX q_;
  std::vector<Isometry> X_WO_;
  double to_objects_ = std::numeric_limits<double>::quiet_NaN();
  double to_itself_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace moma
