#include "controller/safe/round_trip.h"

namespace moma {
namespace {

constexpr double kForget = 0.5;  // [s]
constexpr double kBetter = 0.7;

}  // namespace

void settle(RoundTrip& trip, int age, double squared, double dt) noexcept {
  trip.misfit[age] += dt / kForget * (squared - trip.misfit[age]);
}

bool choose(RoundTrip& trip, double floor) noexcept {
  Eigen::Index best = 0;
  if (!(trip.misfit.minCoeff(&best) + floor < kBetter * (trip.misfit[trip.periods] + floor))) return false;
  if (best == trip.periods) return false;
  trip.periods = static_cast<int>(best);
  return true;
}

}  // namespace moma
