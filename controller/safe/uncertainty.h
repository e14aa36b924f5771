#pragma once

#include <span>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/safe/params.h"
#include "controller/safe/pose_track.h"

namespace moma {

/// Returns the z with P(Z <= z) = probability for a standard normal Z; 0.5 <= probability < 1.
double normal_quantile(double probability) noexcept;

/// Uncertainty of an object's pose: standard deviations per axis, of its origin's position [m] and of a rotation about
/// it [rad]; in addition a tracker's covariance of the position in world axes [m^2].
struct PlaceSpread {
  double position = 0.0;
  double rotation = 0.0;
  bool stated = false;
  Matrix3 P_W = Matrix3::Zero();
};

/// Uncertainty of a distance, propagated from UncertaintyParams to each row. With n the row's normal, p the nearest
/// point of the object or of the robot itself, o the object's origin, b the base's, c the row's coefficients,
///
///   variance of d = s_o^2 + |(p - o) x n|^2 s_R^2              the object, after averaging by its filter,
///                   + |n_xy|^2 s_b^2 + ((p - b) x n)_z^2 s_phi^2                 the base,
///                   + sum over the joints of c_i^2 s_q^2                and the arm,
///
/// to first order. If a tracker states covariances P_p of the position and P_v of the velocity (ObjectState), n^T (P_p
/// + t^2 P_v) n replaces the configured noise and bias of position and linear velocity, with t the age of the
/// measurement when the command acts. That also holds for objects that seem to rest, so that more uncertainty never
/// reduces a margin. A margin is z standard deviations, with P(Z <= z) = `probability`: a row that keeps d - margin
/// keeps d with at least that probability. Floor and self rows have the arm's part.
class Uncertainty {
 public:
  Uncertainty(const UncertaintyParams& params, int base_dof) noexcept;

  bool on() const noexcept { return params_.enabled; }
  double quantile() const noexcept { return z_; }

  /// Uncertainty of an object from its memory, at an age of `lateness` [s]: bias, noise after averaging, for a moving
  /// object its velocity's noise over that time, or a tracker's covariances; plus the growth while it is out of sight.
  PlaceSpread spread(const PoseTrack& track, double lateness) const noexcept;

  /// Returns z standard deviations of a pair's distance. `row` has the coefficients of its row; `states` and `spreads`
  /// are those of all objects, `spreads` empty if places are exact.
  double margin(const ProximityPair& pair, const Kinematics& kinematics, const Eigen::Ref<const VectorX>& row,
                std::span<const ObjectState> states, std::span<const PlaceSpread> spreads) const noexcept;

 private:
  UncertaintyParams params_;
  int base_dof_;
  double z_;
};

/// Writes the row of a pair: its product with the velocities is the rate at which the robot's motion shrinks the
/// distance. `J` is scratch.
void approach_row(const ProximityPair& pair, const Kinematics& kinematics, Matrix3X& J, VectorX& row) noexcept;

/// Returns the velocity of an object's point that is now at p_W.
inline Vector3 velocity_at(const ObjectState& object, const Vector3& p_W) noexcept {
  const Vector3 arm = p_W - object.X_WO.translation();
  return object.V_WO_W.tail<3>() + object.V_WO_W.head<3>().cross(arm);
}

}  // namespace moma
