#pragma once

#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/safe/base_ramp.h"
#include "eval/trial/row.h"
#include "eval/trial/spec.h"
#include "world/world.h"

namespace moma {

/// The exact least distances of a trial: of the robot to objects, and of its own shapes to each other, for pairs that
/// have rows.
class ClearanceWatch {
 public:
  /// Takes a finite state by its `kinematics` and the objects' states. `proximity` has the world's objects.
  void look(const Kinematics& kinematics, Proximity& proximity, std::span<const ObjectState> objects);

  double to_objects() const { return to_objects_; }  ///< [m]; NaN without a measurement
  double to_itself() const { return to_itself_; }    ///< [m]; NaN without a measurement

 private:
  double to_objects_ = kAbsent, to_itself_ = kAbsent;
};

/// Margin beyond the protective separation distance of ISO/TS 15066:2016, 5.5.4 (that of ISO 13855 with the robot's own
/// motion), for each pair of a robot's shape and a moving object:
///
///   S_p = S_H + S_R + S_S,   S_H = v_H (T_R + T_S),   S_R = v_R T_R,   S_S = 1/2 v_R T_S,   margin = d - S_p
///
/// v_H, v_R >= 0 [m/s]: true speeds of the object's and the robot's nearest points towards each other along the line
/// between them. T_R: a control period, the age of object measurements, and the longer latency of the drives, according
/// to the trial's disturbances. T_S: the time in which the base stops at its own accelerations; the arm stops in
/// proportion, so that all velocities fall evenly. C, Z_d and Z_r are 0, because simulated distances are exact. Objects
/// at rest do not count.
///
/// The margin compares controllers and certifies nothing: that takes measured stopping times, rated sensors and a risk
/// assessment. One object per trial.
class SeparationWatch {
 public:
  explicit SeparationWatch(const TrialSpec& spec);

  /// Takes the true state of a sample with its `kinematics`. Pairs further than 3 m beyond the least margin so far do
  /// not count.
  void look(const Kinematics& kinematics, Proximity& proximity, std::span<const ObjectState> objects,
            const VectorX& qdot);

  /// Least margin so far [m]; NaN without a near moving object.
  double least() const noexcept { return least_; }
  double reaction() const noexcept { return reaction_; }

 private:
  BaseRamp ramp_;
  double reaction_;
  double least_ = kAbsent;
  std::vector<ObjectState> moving_;
  Matrix3X J_;
};

}  // namespace moma
