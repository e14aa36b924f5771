#pragma once

#include "controller/describe/describe.h"
#include "controller/model/proximity.h"
#include "controller/types.h"

namespace moma {

using Vector9 = Eigen::Matrix<double, 9, 1>;

/// Memory of an object or of the goal, from its measurements so far.
struct PoseTrack {
  int seen = 0;         ///< number of measurements since its start; 0: unknown
  bool moving = false;  ///< classified as moving
  Vector3 p_W = Vector3::Zero();
  Vector9 R_W = Matrix3::Identity().reshaped();   ///< rotation matrix, column by column
  Vector6 V_W = Vector6::Zero();                  ///< [angular; linear] in world axes, 0 at rest
  double pose_spread = 1.0;                       ///< variance of X_W's noise, in units of one measurement's [1]
  double twist_spread = 1.0;                      ///< variance of V_W's, likewise
  double unseen = 0.0;                            ///< time since the last measurement [s]
  double passed = 0.0;                            ///< time for which sensors have seen through it since [s]
  bool stated = false;                            ///< the last measurement had covariances ...
  Vector9 position_covariance = Vector9::Zero();  ///< ... of its position [m^2], column by column,
  Vector9 velocity_covariance = Vector9::Zero();  ///< and of its linear velocity [(m/s)^2]

  Isometry X_W() const noexcept { return pose_of(R_W.reshaped(3, 3), p_W); }
  void place(const Isometry& X_W) noexcept {
    p_W = X_W.translation();
    R_W = X_W.linear().reshaped();
  }
};

constexpr void describe(auto& v, Of<PoseTrack>) {
  using T = PoseTrack;
  v.member("seen", &T::seen, non_negative("", "measurements since it was begun afresh"));
  v.member("moving", &T::moving, {.text = "whether it is in motion"});
  v.member("position", &T::p_W, {.unit = "m"});
  v.member("rotation", &T::R_W, quantity("1", "matrix, column by column"));
  v.member("velocity", &T::V_W, quantity("rad/s or m/s", "angular, then linear"));
  v.member("pose_spread", &T::pose_spread, non_negative("1", ""));
  v.member("twist_spread", &T::twist_spread, non_negative("1", ""));
  v.member("unseen", &T::unseen, non_negative("s", ""));
  v.member("passed", &T::passed,
           unless_default(non_negative("s", "for which sensors looked through it since the last measurement")));
  v.member("stated", &T::stated, unless_default({.text = "whether the last measurement came with covariances"}));
  v.member("position_covariance", &T::position_covariance,
           unless_default(quantity("m^2", "as measured last, column by column")));
  v.member("velocity_covariance", &T::velocity_covariance,
           unless_default(quantity("(m/s)^2", "as measured last, column by column")));
}

/// Time constants of exponential filters [s]; 0: no filter.
struct PoseFilterParams {
  double resting = 0.0;   ///< of the pose of resting objects,
  double moving = 0.0;    ///< of moving ones,
  double velocity = 0.0;  ///< and of their twists
  double jump = 0.1;      ///< a larger innovation begins a track anew [m, rad]
};

/// Thresholds above which a measured twist counts as motion: `linear` or `angular`, multiples of one measurement's
/// standard deviation [m/s, rad/s]; 0: any twist other than exactly 0.
struct MotionThreshold {
  double linear = 0.0;
  double angular = 0.0;
  double quantile = 0.0;  ///< for a linear velocity with a stated covariance: factor on the root of its trace
};

/// Filters measured poses and twists. The filter moves a pose by its twist, then by max(1/n, T/tau) of the innovation,
/// with n measurements so far: first the mean, later exponential. It treats the twist likewise. A track restarts at an
/// innovation of `jump`, and at transitions between rest and motion. A stateless function of its arguments.
class PoseFilter {
 public:
  PoseFilter(const PoseFilterParams& params, const MotionThreshold& threshold, double control_period) noexcept
      : params_(params), threshold_(threshold), dt_(control_period) {}

  /// `stated`: covariances of the measurement; null: none.
  void measure(const Isometry& X_W, const Vector6& V_W, PoseTrack& track,
               const ObjectCovariance* stated = nullptr) const noexcept;
  /// A step without a measurement: a moving object continues.
  void coast(PoseTrack& track) const noexcept;

 private:
  double gain(double first, double time_constant) const noexcept;
  bool significant(const Vector6& V_W, double spread, const PoseTrack& track) const noexcept;
  void begin(const Isometry& X_W, const Vector6& V_W, bool moving, PoseTrack& track) const noexcept;

  PoseFilterParams params_;
  MotionThreshold threshold_;
  double dt_;
};

/// Moves a pose by a twist at its own origin for `dt` [s].
void advance(const Vector6& V_W, double dt, Isometry& X_W) noexcept;

}  // namespace moma
