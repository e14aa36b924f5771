#pragma once

#include <memory>
#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/safe/base_ramp.h"
#include "controller/safe/params.h"
#include "controller/step.h"

namespace moma {

/// Whether a command leaves a way out of the way of what moves, and a way out where it leaves none. Before what rests a
/// robot can stop (brake_check.h); before what moves it may have to drive off, long before distances shrink.
///
/// A way out is a motion from a fixed set: the base goes to a velocity, by its ramp, and keeps it; the arm brakes. The
/// set has stopping, the command's own velocity, and velocities forwards, backwards, sideways where the base can, and
/// turning. Objects in motion go on as they do. A way out is clear where for `horizon` seconds the robot stays `margin`
/// from what moves and 2 cm from what rests; where it has less now, what it has, of the first no less than half, which
/// is to be regained at 0.1 m/s. A command passes where after one period of it some way out is clear (backup sets:
/// Gurriet et al., IEEE Access 8, 2020; here with motions of which one goes on for ever only as far as the horizon).
/// Where none is, the base does what begins the best way out that begins now: the one that is touched last, or where
/// nothing is touched keeps away furthest and leads to where the robot may stand longest.
///
/// Nothing is remembered: the same inputs give the same bits. One per controller; set_objects() alone takes memory.
class Evasion {
 public:
  /// `acceleration` per velocity, resolved. `share`: of the base's own that its ramp takes, 0: all.
  Evasion(std::shared_ptr<const RobotModel> model, const EvasionParams& params, const VectorX& acceleration,
          double share, double control_period);

  void set_objects(std::span<const ObjectShape> objects);
  /// Shares of its accelerations with which the base's drive follows.
  void set_shares(const BaseRamp::Shares& shares) noexcept { ramp_.set_shares(shares); }

  /// `o`: where the command begins to act. True where the command passes, or nothing in motion is near enough to count;
  /// false: `base` has the velocity coordinates of the base that lead out, as of the end of this period.
  bool passes(const Observation& o, const VectorX& command, VectorX& base) noexcept;

  /// Velocities of the base's coordinates that ways out go to, further to 0 and the command's own.
  std::span<const Vector3> velocities() const noexcept { return velocities_; }
  /// Of the last call: ways out that were predicted.
  int tried() const noexcept { return tried_; }

 private:
  double reach(const Observation& o, const VectorX& command) noexcept;
  void look(double range, double& moving, double& resting) noexcept;
  void drive(const Vector3& target, double dt) noexcept;
  Vector3 leading(const VectorX& velocities) const noexcept;
  void begin(const Observation& o) noexcept;
  void go_on(const Vector3& target) noexcept;
  bool is_clear(const Observation& o, const VectorX& command, const Vector3& target, double range) noexcept;
  double worth(const Observation& o, const Vector3& target, double range) noexcept;

  std::shared_ptr<const RobotModel> model_;
  EvasionParams params_;
  VectorX acceleration_;
  double dt_;
  BaseRamp ramp_;
  double share_;
  std::vector<Vector3> velocities_;  // of the base's coordinates
  Kinematics kinematics_;
  Proximity proximity_;
  std::vector<ObjectState> states_;
  std::vector<double> radii_;  // of spheres about the objects' origins that enclose them [m]
  double reach_ = 0.0;         // of the robot about the base's origin [m]
  Vector3 base_ = Vector3::Zero(), velocity_ = Vector3::Zero();
  VectorX q_, qdot_, mean_;
  double need_moving_ = 0.0, need_resting_ = 0.0;
  int tried_ = 0;
};

}  // namespace moma
