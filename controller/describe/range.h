#pragma once

#include <limits>

namespace moma {

/// Range of accepted numbers. Closed by default; infinities are inside only if a bound is infinite.
struct Range {
  double low = -std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::max();
  bool open_low = false;
  bool open_high = false;

  static constexpr Range any() { return {}; }
  static constexpr Range positive() { return {0.0, std::numeric_limits<double>::max(), true, false}; }
  static constexpr Range positive_or_inf() { return {0.0, std::numeric_limits<double>::infinity(), true, false}; }
  static constexpr Range non_negative() { return {0.0, std::numeric_limits<double>::max(), false, false}; }
  static constexpr Range non_negative_or_inf() { return {0.0, std::numeric_limits<double>::infinity(), false, false}; }

  /// False for NaN.
  constexpr bool contains(double value) const {
    return value >= low && value <= high && !(open_low && value == low) && !(open_high && value == high);
  }
};

}  // namespace moma
