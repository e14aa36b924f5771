#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/safe/base_ramp.h"
#include "controller/safe/params.h"
#include "controller/step.h"

namespace moma {

/// Checks whether a command leaves a way out from moving objects, and finds one if it does not. In front of an object
/// at rest a robot can stop (brake_check.h); it may have to drive away from a moving one, long before distances shrink.
///
/// A way out is a motion of a fixed set: the base ramps to a velocity and keeps it, the arm brakes. The set has
/// stopping, the command's own velocity, and velocities forwards, backwards, sideways if the base can, and turning.
/// Objects keep their twists. A way out is clear if for `horizon` seconds the robot stays at least `margin` plus
/// `reaction` times its base's speed from each moving object and 2 cm from each resting one, or as far as it is from
/// that object now if this is less. It is checked `first` after the command's period, so that the robot approaches an
/// object within the margin no faster than it stops in that time, and every `step` from then on. A command passes if
/// some way out is clear after one period of it (backup sets: Gurriet et al., IEEE Access 8, 2020; here the motions end
/// at the horizon). If none is clear, the base starts the best way out that begins now: the one with the latest contact
/// or, without contact, the one that keeps the largest distance and ends where the robot may stand longest.
///
/// Without memory: the same inputs give the same bits. One per controller; only set_objects() allocates.
class Evasion {
 public:
  /// `acceleration` per velocity, resolved. `share`: of the base's own acceleration that the ramp uses, 0: all.
  /// `max_linear`: greatest speed of the base that its commands may have [m/s].
  Evasion(std::shared_ptr<const RobotModel> model, const EvasionParams& params, const VectorX& acceleration,
          double share, double max_linear, double control_period);

  void set_objects(std::span<const ObjectShape> objects);
  /// Shares of its accelerations with which the base's drive follows.
  void set_shares(const BaseRamp::Shares& shares) noexcept { ramp_.set_shares(shares); }

  /// `o`: state in which the command begins to act. True if the command passes, or if no moving object is near. False:
  /// `base` has the base's velocity coordinates of the way out, at the end of this period.
  bool passes(const Observation& o, const VectorX& command, VectorX& base) noexcept;

  /// Target velocities of ways out, besides 0 and the command's own.
  std::span<const Vector3> velocities() const noexcept { return velocities_; }
  /// Number of ways out predicted in the last call.
  int tried() const noexcept { return tried_; }

 private:
  double reach(const Observation& o, const VectorX& command) noexcept;
  double look(double range) noexcept;
  void drive(const Vector3& target, double dt) noexcept;
  void begin(const Observation& o) noexcept;
  void go_on(const Vector3& target, double dt) noexcept;
  bool is_clear(const Observation& o, const VectorX& command, const Vector3& target) noexcept;
  double worth(const Observation& o, const Vector3& target) noexcept;

  std::shared_ptr<const RobotModel> model_;
  EvasionParams params_;
  VectorX acceleration_;
  double dt_;
  BaseRamp ramp_;
  double share_;
  std::vector<Vector3> velocities_;  // in the base's coordinates
  std::size_t clear_ = 0;            // index of the last clear one, which is tried first; no result depends on it
  Kinematics kinematics_;
  Proximity proximity_;
  std::vector<ObjectState> states_;
  std::vector<double> radii_;        // radii of spheres about the objects' origins that enclose them [m]
  std::vector<double> gaps_, need_;  // distances of the objects, and those that a way out keeps [m]
  double range_;                     // largest distance that a way out keeps [m]
  int num_linear_;
  double reach_ = 0.0;  // radius of the robot about the base's origin [m]
  Vector3 base_ = Vector3::Zero(), velocity_ = Vector3::Zero();
  VectorX q_, qdot_, mean_;
  int tried_ = 0;
};

}  // namespace moma
