#pragma once

#include <span>
#include <vector>

#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/safe/params.h"
#include "controller/safe/pose_track.h"

namespace moma {

/// The z with P(Z <= z) = probability for a standard normal Z; 0.5 <= probability < 1.
double normal_quantile(double probability) noexcept;

/// What is not known of an object's place: standard deviations per axis, of its origin's position [m] and of a rotation
/// about it [rad]; where a tracker states it, a covariance of the position in world axes [m^2] beside these.
struct PlaceSpread {
  double position = 0.0;
  double rotation = 0.0;
  bool stated = false;
  Matrix3 P_W = Matrix3::Zero();
};

/// How far a distance may be off, stated once (UncertaintyParams) and carried to each row: with n the row's normal, p
/// the nearest point of the object or of the robot itself, o the object's origin, b the base's, c the row's
/// coefficients,
///
///   variance of d = s_o^2 + |(p - o) x n|^2 s_R^2                       the object, as far as its filter has averaged
///   it,
///                   + |n_xy|^2 s_b^2 + ((p - b) x n)_z^2 s_phi^2                 the base,
///                   + sum over the joints of c_i^2 s_q^2                and the arm,
///
/// to first order in what is off. Where a tracker states covariances P_p of the position and P_v of the velocity
/// (ObjectState), n^T (P_p + t^2 P_v) n takes the place of the configured noise and bias of position and linear
/// velocity, t being how old the measurement is when the command acts: also of what seems to be at rest, so that more
/// uncertainty never makes a margin less. A margin is z standard deviations, with P(Z <= z) = `probability`: a row that
/// keeps d - margin keeps d with at least that probability as far as the distance goes. Floor and self rows have the
/// arm's part.
class Uncertainty {
 public:
  Uncertainty(const UncertaintyParams& params, int base_dof) noexcept;

  bool on() const noexcept { return params_.enabled; }
  double quantile() const noexcept { return z_; }

  /// Of an object by what is remembered of it, `lateness` [s] old: bias, noise as far as it is not averaged, where it
  /// moves its velocity's noise over that time, or what a tracker stated; where it is not seen what that adds.
  PlaceSpread spread(const PoseTrack& track, double lateness) const noexcept;

  /// z standard deviations of a pair's distance. `row` has the coefficients of its row, `object` is null for a pair
  /// without one.
  double margin(const ProximityPair& pair, const Kinematics& kinematics, const Eigen::Ref<const VectorX>& row,
                const ObjectState* object, const PlaceSpread& spread) const noexcept;

 private:
  UncertaintyParams params_;
  int base_dof_;
  double z_;
};

}  // namespace moma
