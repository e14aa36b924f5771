#pragma once

#include "controller/types.h"
#include "world/sensing/disturbances.h"
#include "world/sensing/streams.h"

namespace moma {

/// Dead reckoning of a base: true motions between control steps, added up with errors. A motion by s metres along an
/// arc that turns by a is measured as
///   s' = (1 + e_d) s + w_p sqrt(s) n,   a' = (1 + e_t) a + e_h s + w_r sqrt(s) n,   w_p also across the way,
/// (and, where a wheel slips, with the probability 1 - exp(-rate s), a normal draw more of each)
/// with e_d, e_t, e_h drawn once for a trial and n anew for each step. Along an arc the chord points half the turn off
/// the heading, so that s' and a' are laid down as an arc again (exact for differential drives but for
/// sinc(a/2), below 1e-4 for turns of a control step). The model is that of Borenstein & Feng (IEEE T-RA 12(6), 1996)
/// for what is systematic, and of Chong & Kleeman (ICRA 1997), variance in proportion to the way, for what is not.
class Odometry {
 public:
  Odometry(const OdometryErrors& errors, const DisturbanceStreams& streams);

  /// Whether there is any error; without one the truth is not touched, not even by rounding.
  bool on() const noexcept { return on_; }
  /// The pose (x, y, phi) that dead reckoning gives at step k = 0, 1, 2, ... (each once, in order) for the true
  /// `pose`. The first one is the truth.
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
