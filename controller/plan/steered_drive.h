#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "controller/plan/path.h"
#include "controller/safe/braking.h"

namespace moma {

/// Step of simulated drives [s].
inline constexpr double kDriveStep = 0.02;

/// Returns the velocity after a step from `now` towards `wanted`.
inline double ramped(double now, double wanted, double acceleration) noexcept {
  return now + std::clamp(wanted - now, -acceleration * kDriveStep, acceleration * kDriveStep);
}

/// Returns the speed from which a motion that is ramped down in steps stops within `room`: it covers half a step more
/// than one that falls evenly.
inline double stopping(double room, double deceleration) noexcept {
  return stoppable_speed(room, deceleration, 0.5 * kDriveStep);
}

/// Speeds (v, omega) of a differential base in a motion whose velocities are in W [m/s, rad/s].
inline Vector2 driving_speeds(const MotionState& motion) noexcept {
  return {std::cos(motion.c[2]) * motion.v[0] + std::sin(motion.c[2]) * motion.v[1], motion.v[2]};
}

/// A differential base's drive to a point, from its present speeds to rest. The base turns to the point while it
/// drives, instead of turning on the spot first, and keeps the heading with which it arrives:
///
///   v = cos(off) min(linear, stoppable_speed(d)),   omega = sign(off) min(angular, stoppable_speed(|off|)),
///
/// with the distance d and the angle `off` between the driving direction (backwards where the point is behind the
/// start) and the point. Accelerations ramp both, and the faster wheel bounds v. plan() simulates this law; add_to()
/// makes overlapping triangles of its velocities, so that they are linear between even times.
class SteeredDrive {
 public:
  /// Largest number of path parts of a drive to rest from rest.
  static constexpr int kNodes = 38;
  static constexpr double kMostTime = 10.0;  ///< [s]
  static constexpr double kReached = 0.003;  ///< distance at which a point is reached [m]

  /// A point that is not stopped at: the drive, at `speed` at most, ends in motion nearer than `reach`, or at the time
  /// `until`.
  struct Passing {
    double reach, speed, until;  // [m, m/s, s]
  };

  /// Plans from (x, y, phi), at the speeds (v, omega), to `point` [m], or past it. False if that takes longer than
  /// kMostTime: an arc never reaches some points. Cost: time/20 ms steps of simulation, about 0.1 us each. Does not
  /// allocate.
  bool plan(const MotionLimits& limits, const Vector3& from, const Vector2& speeds, const Vector2& point,
            const Passing* passing = nullptr) noexcept;

  double time() const noexcept { return time_; }
  /// Cost of its simulation: 0.8 s of a drive are simulated in the time of a check.
  long checks() const noexcept { return static_cast<long>(time_ / 0.8); }
  /// End of the parts of add_to(), at most a few centimetres from the point.
  const Vector3& end() const noexcept { return end_; }
  /// Length of the way, and sum of all turning [m, rad].
  double way() const noexcept { return way_; }
  double turned() const noexcept { return turned_; }
  /// Adds the drive's parts to a path with room for them and raises its duration to the drive's.
  void add_to(Path& path) const noexcept;

 private:
  std::array<Vector3, kNodes + 2> speed_;  // (vx, vy, omega) in W at times i spacing_
  double spacing_ = 0.0, time_ = 0.0, way_ = 0.0, turned_ = 0.0;
  Vector3 end_ = Vector3::Zero();
};

}  // namespace moma
