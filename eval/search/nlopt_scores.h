#pragma once

#include <algorithm>
#include <limits>

namespace moma::tune {

/// The scores that one NLopt run gets. A cut candidate gets its estimate (Evaluation::merit), but never a better score
/// than a fully measured one of this run: at least the worst full score before it, and a later full score is reported
/// as no worse than any cut one before it. In either order no cut candidate looks better than a fully measured one.
/// Only the ranking among candidates worse than a cut one is lost.
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
