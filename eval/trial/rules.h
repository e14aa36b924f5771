#pragma once

#include "controller/status.h"
#include "controller/types.h"
#include "eval/trial/spec.h"
#include "world/plant/plant.h"

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
/// nearest). A half is still if each coordinate is within stuck.motion of the half before, and goal and objects are at
/// rest throughout. Two consecutive still halves mean stuck. A robot that noise shakes never stands still: where
/// anything is disturbed, the rule compares means over halves instead of their ends, by the time and motion of
/// stuck.disturbed.
class StuckTracker {
 public:
  StuckTracker(const StuckRule& rule, bool disturbed, double control_period);
  /// Time in which nothing moved once the robot is stuck [s].
  double time() const noexcept { return still_rule_.time; }
  /// Takes sample k = 0, 1, ... of `plant`. Returns true if stuck. `at_rest()` is asked at the ends of halves: do goal
  /// and objects rest from now on?
  template <class AtRest>
  bool update(long k, const PlantState& plant, AtRest at_rest) {
    if (half_ == 0) return false;
    const bool due = k % half_ == 0;
    if (means_ || due) add(plant);
    return due && end_half(at_rest());
  }

 private:
  void add(const PlantState& plant);
  bool end_half(bool at_rest);

  bool means_;
  StillRule still_rule_;
  long half_ = 0;
  int still_ = 0;
  int added_ = 0;
  bool rest_at_start_ = false;
  VectorX sum_, place_;  // base and joints
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
