#pragma once

#include <algorithm>
#include <limits>

namespace moma::tune {

/// What one NLopt run is told about candidates. One that was cut short is told by its estimate (Evaluation::merit),
/// but never better than any full score of this run: at least the worst full score told before, and a full score
/// that comes later is told as no worse than any cut one before it. So in either order no cut candidate looks better
/// than a fully measured one; what is lost is the ranking among candidates that are worse than a cut one anyway.
class NloptScores {
 public:
  double operator()(double value, bool cut) {
    if (cut) {
      value = std::max(value, worst_full_);
      least_cut_ = std::min(least_cut_, value);
    } else {
      value = std::min(value, least_cut_);
      worst_full_ = std::max(worst_full_, value);
    }
    return value;
  }

 private:
  double worst_full_ = -std::numeric_limits<double>::infinity();
  double least_cut_ = std::numeric_limits<double>::infinity();
};

}  // namespace moma::tune
