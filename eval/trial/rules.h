#pragma once

#include "controller/types.h"
#include "eval/trial/spec.h"

namespace moma {

/// Returns the least number of control periods that last at least `seconds`, with a tolerance of a billionth of a
/// period for rounding. 0 for 0; for infinity a number that no trial reaches.
long periods_in(double seconds, double control_period) noexcept;

/// Rule of success: both errors within tolerance at every sample for the dwell time.
class DwellRule {
 public:
  DwellRule(const SuccessRule& rule, double control_period) noexcept;
  /// Call it at every sample k = 0, 1, ...; returns true once the dwell is complete. `l1` matters only if the rule's
  /// tolerance for it is finite.
  bool update(long k, double position_error, double orientation_error, double l1 = 0.0) noexcept;
  bool inside() const noexcept { return first_ >= 0; }
  /// Sample at which the present stay within tolerance began; -1 outside.
  long first() const noexcept { return first_; }

 private:
  double position_, orientation_, l1_;
  long periods_;
  long first_ = -1;
};

/// Rule of being stuck. It divides time into halves of stuck.time from t = 0 on (whole control periods, rounded to the
/// nearest). A half is still if no coordinate changes by stuck.motion or more from its start to its end, and goal and
/// objects are at rest throughout. Two consecutive still halves mean stuck.
class StuckTracker {
 public:
  StuckTracker(const StuckRule& rule, double control_period) noexcept;
  /// True if sample k ends a half, so that update() is due (also at k = 0).
  bool due(long k) const noexcept { return half_ > 0 && k % half_ == 0; }
  /// `at_rest`: goal and objects rest from now on. Returns true if stuck.
  bool update(const Vector3& base, const VectorX& q, bool at_rest);

 private:
  long half_;
  double motion_;
  int still_ = 0;
  bool started_ = false;
  bool rest_at_start_ = false;
  Vector3 base_ = Vector3::Zero();
  VectorX q_;
};

/// Rule of infeasibility: consecutive `brake` steps for infeasible.time.
class InfeasibleTracker {
 public:
  InfeasibleTracker(const InfeasibleRule& rule, double control_period) noexcept
      : periods_(periods_in(rule.time, control_period)) {}
  void count(Fallback fallback) noexcept { run_ = fallback == Fallback::kBrake ? run_ + 1 : 0; }
  bool reached() const noexcept { return run_ > 0 && run_ >= periods_; }

 private:
  long periods_;
  long run_ = 0;
};

}  // namespace moma
