#pragma once

#include "controller/types.h"
#include "world/sensing/disturbances.h"
#include "world/sensing/streams.h"

namespace moma {

/// Dead reckoning of a base: sums up true motions between control steps with errors. A motion by s metres along an arc
/// that turns by a is measured as
///   s' = (1 + e_d) s + w_p sqrt(s) n,   a' = (1 + e_t) a + e_h s + w_r sqrt(s) n,   w_p also across the way,
/// (plus, if a wheel slips, with the probability 1 - exp(-rate s), another normal draw of each) with e_d, e_t, e_h
/// drawn once per trial and n for each step. The chord of an arc is half the turn off the heading; s' and a' form an
/// arc again (exact for differential drives except for sinc(a/2), below 1e-4 for turns of a control step). Systematic
/// errors follow Borenstein & Feng (IEEE T-RA 12(6), 1996); random ones follow Chong & Kleeman (ICRA 1997), with
/// variance in proportion to the distance.
class Odometry {
 public:
  Odometry(const OdometryErrors& errors, const DisturbanceStreams& streams);

  /// True if there is any error; otherwise the true pose stays unchanged, even by rounding.
  bool on() const noexcept { return on_; }
  /// Returns the estimated pose (x, y, phi) at step k = 0, 1, 2, ... (each once, in order) for the true `pose`. The
  /// first estimate is exact.
  Vector3 update(long k, const Vector3& pose);

 private:
  OdometryErrors errors_;
  DisturbanceStreams streams_;
  bool on_;
  double distance_ = 0.0, turn_ = 0.0, heading_ = 0.0;  // e_d, e_t, e_h
  Vector3 last_ = Vector3::Zero();
  Vector3 reckoned_ = Vector3::Zero();
};

}  // namespace moma
