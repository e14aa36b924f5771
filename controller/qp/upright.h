#pragma once

#include "controller/params.h"
#include "controller/qp/problem.h"
#include "controller/safe/braking.h"
#include "controller/situation.h"

namespace moma {

/// The row of Observation::upright: d tilt/dt <= min(gain (s - tilt), v), a velocity damper (Faverjon & Tournassoud,
/// ICRA 1987) on the tilt with its stop s = (1 - margin) angle, or the tilt of the goal's own pose if that is larger,
/// but at most the angle. v is the rate from which a share of the joints' deceleration still stops at s
/// (stoppable_speed(), as in CollisionRows). d tilt/dt = m J_omega qdot (tilt_direction()).
class UprightRow {
 public:
  UprightRow(const UprightParams& params, const BrakingParams& braking, const Deceleration& deceleration,
             int num_velocities)
      : params_(params), braking_(braking), deceleration_(deceleration), row_(num_velocities) {}

  /// The largest number of rows that add() appends.
  int most() const noexcept { return params_.enabled ? 1 : 0; }
  /// Appends nothing without a constraint, or with a vertical axis.
  void add(const Situation& now, QpProblem& problem) noexcept;

 private:
  UprightParams params_;
  BrakingParams braking_;
  Deceleration deceleration_;
  VectorX row_;
};

}  // namespace moma
