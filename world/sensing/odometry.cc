#include "world/sensing/odometry.h"

#include <cmath>

namespace moma {

Odometry::Odometry(const OdometryErrors& errors, const DisturbanceStreams& streams)
    : errors_(errors), streams_(streams), on_(!is_off(errors)) {
  using enum DisturbanceSource;
  distance_ = streams_.sensing(kOdometryDistance, 0).normal(0.0, errors_.distance);
  turn_ = streams_.sensing(kOdometryTurn, 0).normal(0.0, errors_.turn);
  heading_ = streams_.sensing(kOdometryHeading, 0).normal(0.0, errors_.heading);
}

Vector3 Odometry::update(long k, const Vector3& pose) {
  using enum DisturbanceSource;
  if (k == 0) {
    last_ = reckoned_ = pose;
    return reckoned_;
  }
  const double turn = pose.z() - last_.z();
  // The chord in the frame turned by half the angle: for an arc it points straight ahead.
  Vector2 chord = Eigen::Rotation2Dd(-(last_.z() + 0.5 * turn)) * Vector2(pose.head<2>() - last_.head<2>());
  const double way = chord.norm();
  double measured_turn = (1.0 + turn_) * turn + heading_ * way;
  chord *= 1.0 + distance_;
  const double root = std::sqrt(way);
  if (errors_.walk.position > 0.0) {
    Draws draws = streams_.sensing(kOdometryWalkPosition, k);
    chord.x() += draws.normal(0.0, errors_.walk.position * root);
    chord.y() += draws.normal(0.0, errors_.walk.position * root);
  }
  if (errors_.walk.rotation > 0.0)
    measured_turn += streams_.sensing(kOdometryWalkRotation, k).normal(0.0, errors_.walk.rotation * root);
  if (errors_.slip.rate > 0.0) {
    Draws draws = streams_.sensing(kOdometrySlip, k);
    if (draws.uniform() < -std::expm1(-errors_.slip.rate * way)) {
      // Along the motion if there is one; wheels that spin on the spot measure it ahead.
      const Vector2 ahead = way > 0.0 ? Vector2(chord.normalized()) : Vector2::UnitX();
      chord += draws.normal(0.0, errors_.slip.distance) * ahead;
      measured_turn += draws.normal(0.0, errors_.slip.turn);
    }
  }
  reckoned_.head<2>() += Eigen::Rotation2Dd(reckoned_.z() + 0.5 * measured_turn) * chord;
  reckoned_.z() += measured_turn;
  last_ = pose;
  return reckoned_;
}

}  // namespace moma
