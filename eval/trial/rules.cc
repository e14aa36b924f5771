#include "eval/trial/rules.h"

#include <algorithm>
#include <cmath>

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

StuckTracker::StuckTracker(const StuckRule& rule, bool disturbed, double control_period)
    : means_(disturbed), still_rule_(disturbed ? rule.disturbed : rule.ends) {
  if (std::isfinite(rule.ends.time) && std::isfinite(time()))
    half_ = std::max(1L, std::lround(0.5 * time() / control_period));
}

void StuckTracker::add(const PlantState& plant) {
  if (added_ == 0) sum_.setZero(3 + plant.q.size());
  sum_.head<3>() += plant.base;
  sum_.tail(plant.q.size()) += plant.q;
  ++added_;
}

bool StuckTracker::end_half(bool at_rest) {
  sum_ /= added_;
  added_ = 0;
  const bool still = place_.size() > 0 && rest_at_start_ && (sum_ - place_).cwiseAbs().maxCoeff() < still_rule_.motion;
  still_ = still ? still_ + 1 : 0;
  rest_at_start_ = at_rest;
  place_.swap(sum_);
  return still_ >= 2;
}

}  // namespace moma
