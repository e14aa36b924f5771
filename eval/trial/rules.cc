#include "eval/trial/rules.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace moma {

long periods_in(double seconds, double control_period) noexcept {
  const double periods = std::ceil(seconds / control_period * (1.0 - 1e-12) - 1e-9);
  constexpr double kMost = 1e15;
  return static_cast<long>(std::clamp(periods, 0.0, kMost));
}

DwellRule::DwellRule(const SuccessRule& rule, double control_period) noexcept
    : position_(rule.position),
      orientation_(rule.orientation),
      l1_(rule.l1),
      periods_(periods_in(rule.dwell, control_period)) {}

bool DwellRule::update(long k, double position_error, double orientation_error, double l1) noexcept {
  if (!(position_error <= position_ && orientation_error <= orientation_ && l1 <= l1_)) {
    first_ = -1;
    return false;
  }
  if (first_ < 0) first_ = k;
  return k - first_ >= periods_;
}

StuckTracker::StuckTracker(const StuckRule& rule, double control_period) noexcept
    : half_(std::isfinite(rule.time) ? std::max(1L, std::lround(0.5 * rule.time / control_period)) : 0),
      motion_(rule.motion) {}

bool StuckTracker::update(const Vector3& base, const VectorX& q, bool at_rest) {
  const bool still = started_ && rest_at_start_ && (base - base_).cwiseAbs().maxCoeff() < motion_ &&
                     (q.size() == 0 || (q - q_).cwiseAbs().maxCoeff() < motion_);
  still_ = still ? still_ + 1 : 0;
  started_ = true;
  rest_at_start_ = at_rest;
  base_ = base;
  q_ = q;
  return still_ >= 2;
}

}  // namespace moma
