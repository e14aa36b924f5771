#include "controller/safe/pose_track.h"

#include <algorithm>
#include <cmath>

#include "controller/model/kinematics.h"

namespace moma {
namespace {

void turn(const Vector3& rotation_W, Isometry& X_W) noexcept {
  const double angle = rotation_W.norm();
  if (angle > 0.0) X_W.linear() = Eigen::AngleAxisd(angle, rotation_W / angle).toRotationMatrix() * X_W.linear();
}

// Variance of a filtered value, in units of one measurement's, after a measurement with this gain.
double averaged(double spread, double gain) noexcept { return (1.0 - gain) * (1.0 - gain) * spread + gain * gain; }

}  // namespace

void advance(const Vector6& V_W, double dt, Isometry& X_W) noexcept {
  X_W.translation() += dt * V_W.tail<3>();
  turn(dt * V_W.head<3>(), X_W);
}

double PoseFilter::gain(double first, double time_constant) const noexcept {
  return time_constant > dt_ ? std::max(first, dt_ / time_constant) : 1.0;
}

// A tracker's covariance is that after its own filter: averaging here does not reduce it.
bool PoseFilter::significant(const Vector6& V_W, double spread, const PoseTrack& track) const noexcept {
  const double root = std::sqrt(spread);
  const Vector9& P = track.velocity_covariance;
  const double linear =
      track.stated ? threshold_.quantile * std::sqrt(std::max(0.0, P[0] + P[4] + P[8])) : threshold_.linear * root;
  return V_W.tail<3>().norm() > linear || V_W.head<3>().norm() > threshold_.angular * root;
}

void PoseFilter::begin(const Isometry& X_W, const Vector6& V_W, bool moving, PoseTrack& track) const noexcept {
  track.seen = 1;
  track.moving = moving;
  track.place(X_W);
  track.V_W = V_W;
  track.pose_spread = 1.0;
  track.unseen = track.passed = 0.0;
}

void PoseFilter::measure(const Isometry& X_W, const Vector6& V_W, PoseTrack& track,
                         const ObjectCovariance* stated) const noexcept {
  const ObjectCovariance none;
  const ObjectCovariance& covariance = stated != nullptr ? *stated : none;
  track.stated = stated != nullptr;
  track.position_covariance = covariance.position_W.reshaped();
  track.velocity_covariance = covariance.velocity_W.reshaped();
  // A twist of exactly 0 states that the object is at rest.
  const bool at_rest = V_W.isZero(0.0);
  const bool noisy = threshold_.linear > 0.0 || threshold_.angular > 0.0 || (track.stated && threshold_.quantile > 0.0);
  if (track.seen == 0) {
    track.twist_spread = 1.0;
    begin(X_W, V_W, !at_rest && significant(V_W, 1.0, track), track);
    return;
  }
  ++track.seen;
  track.unseen = track.passed = 0.0;
  const double first = 1.0 / track.seen;
  if (at_rest) {
    track.V_W.setZero();
    track.twist_spread = 1.0;
  } else if (track.moving || noisy) {
    const double g = gain(first, params_.velocity);
    track.V_W += g * (V_W - track.V_W);
    track.twist_spread = averaged(track.twist_spread, g);
  } else {
    track.V_W = V_W;
    track.twist_spread = 1.0;
  }
  const bool moving = !at_rest && significant(track.V_W, track.twist_spread, track);
  if (moving != track.moving) {
    begin(X_W, track.V_W, moving, track);
    return;
  }
  Isometry X = track.X_W();
  if (moving) advance(track.V_W, dt_, X);
  const Vector3 away = X_W.translation() - X.translation();
  const Vector3 turned = log_so3(X_W.linear() * X.linear().transpose());
  if (!(away.norm() < params_.jump && turned.norm() < params_.jump)) {
    track.twist_spread = 1.0;
    begin(X_W, V_W, moving, track);
    return;
  }
  const double g = gain(first, moving ? params_.moving : params_.resting);
  X.translation() += g * away;
  turn(g * turned, X);
  track.place(X);
  track.pose_spread = averaged(track.pose_spread, g);
}

void PoseFilter::coast(PoseTrack& track) const noexcept {
  if (track.seen == 0) return;
  if (track.moving) {
    Isometry X = track.X_W();
    advance(track.V_W, dt_, X);
    track.place(X);
  }
  track.unseen += dt_;
}

}  // namespace moma
