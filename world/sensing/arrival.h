#pragma once

#include <cmath>
#include <utility>

#include "world/draws.h"
#include "world/sensing/delay_line.h"
#include "world/sensing/disturbances.h"

namespace moma {

/// Draws an additional delay in control periods, uniform from 0 to `jitter`, or DelayLine::kLost.
inline long arrival(const Irregularity& irregularity, long jitter, Draws draws) {
  const bool lost = draws.uniform() < irregularity.dropout;
  const auto more = static_cast<long>(std::floor(draws.uniform() * static_cast<double>(jitter + 1)));
  return lost ? -1 : more < jitter ? more : jitter;
}

/// Replaces `value` by the line's output at step k. `draws()` makes the step's own draws; it is called only if they
/// matter. `jitter` in control periods.
template <class T, class MakeDraws>
void pass(DelayLine<T>& line, long k, T& value, const Irregularity& irregularity, long jitter, MakeDraws draws) {
  if (irregularity == Irregularity{})
    line.pass(k, value);
  else
    line.pass(k, value, arrival(irregularity, jitter, draws()));
}

}  // namespace moma
