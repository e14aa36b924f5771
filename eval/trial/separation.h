#pragma once

#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/safe/base_ramp.h"
#include "eval/trial/row.h"
#include "eval/trial/spec.h"

namespace moma {

/// How much of the distance to what moves is left beyond the protective separation distance of ISO/TS 15066:2016,
/// 5.5.4 (that of ISO 13855 with the robot's own motion), for each pair of a robot's shape and an object in motion,
///
///   S_p = S_H + S_R + S_S,   S_H = v_H (T_R + T_S),   S_R = v_R T_R,   S_S = 1/2 v_R T_S,   margin = d - S_p
///
/// v_H, v_R >= 0: speeds [m/s] at which the object's and the robot's nearest points approach each other along the line
/// between them, of the true motion. T_R: a control period, the age of what is measured of objects, and the lateness of
/// the later one of the drives, as the trial's disturbances have them. T_S: the time in which the base stops at its own
/// accelerations; the arm, which stops in less, goes along in proportion, so that all velocities fall evenly. C, Z_d
/// and Z_r are 0: simulated distances are exact. Objects at rest do not count: they are no persons that come.
///
/// A measure to compare controllers by. It is no certification of anything: that takes a robot's own measured stopping
/// times, its sensors' ratings, and an assessment of the risks. One per trial.
class SeparationWatch {
 public:
  explicit SeparationWatch(const TrialSpec& spec);

  /// The true state of a sample; `kinematics` is that of it. Pairs further than 3 m beyond the least margin so far do
  /// not count.
  void look(const Kinematics& kinematics, Proximity& proximity, std::span<const ObjectState> objects,
            const VectorX& qdot);

  /// Least margin so far [m]; NaN where nothing moved near.
  double least() const noexcept { return least_; }
  double reaction() const noexcept { return reaction_; }

 private:
  const RobotModel& model_;
  BaseRamp ramp_;
  double reaction_;
  double least_ = kAbsent;
  std::vector<ObjectState> moving_;
  Matrix3X J_;
};

}  // namespace moma
