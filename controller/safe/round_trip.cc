#include "controller/safe/round_trip.h"

namespace moma {

void settle(RoundTrip& trip, int age, double squared, double part) noexcept {
  trip.misfit[age] += part * (squared - trip.misfit[age]);
}

bool choose(RoundTrip& trip, double floor, double better) noexcept {
  Eigen::Index best = 0;
  if (!(trip.misfit.minCoeff(&best) + floor < better * (trip.misfit[trip.periods] + floor))) return false;
  if (best == trip.periods) return false;
  trip.periods = static_cast<int>(best);
  return true;
}

}  // namespace moma
