#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "world/draws.h"
#include "world/sensing/disturbances.h"

namespace moma {

/// Output of a line before its first input arrives.
enum class BeforeFirst { kHoldFirst, kPrototype };

/// Delays values of consecutive steps by a number of steps, which may vary. Allocates only in the constructor, provided
/// that assigning a T of the prototype's size does not allocate.
template <typename T>
class DelayLine {
 public:
  static constexpr long kLost = -1;

  /// `steps`: delay of every value; `more`: largest additional delay.
  DelayLine(long steps, const T& prototype, BeforeFirst before, long more = 0)
      : steps_(steps),
        before_(before),
        ring_(steps + more > 0 ? static_cast<std::size_t>(steps + more) + 1 : 0, prototype),
        due_(ring_.size(), 0),
        held_(prototype) {}

  /// Replaces the value of step k = 0, 1, 2, ... (each once, in order), which arrives after `steps` and `more` steps or
  /// is kLost, by the newest value that has arrived.
  void pass(long k, T& value, long more = 0) {
    if (k == 0 && before_ == BeforeFirst::kHoldFirst) held_ = value;
    if (ring_.empty()) {  // without delay, but possibly lost
      if (more != kLost) held_ = value;
      value = held_;
      return;
    }
    const auto at = [this](long step) { return static_cast<std::size_t>(step) % ring_.size(); };
    ring_[at(k)] = value;
    due_[at(k)] = more == kLost ? kLost : k + steps_ + more;
    const long oldest = std::max({held_from_ + 1, k + 1 - static_cast<long>(ring_.size()), 0L});
    for (long made = k; made >= oldest; --made) {
      const long due = due_[at(made)];
      if (due == kLost || due > k) continue;
      held_ = ring_[at(made)];
      held_from_ = made;
      break;
    }
    value = held_;
  }

 private:
  long steps_;
  BeforeFirst before_;
  std::vector<T> ring_;
  std::vector<long> due_;
  T held_;
  long held_from_ = -1;
};

/// Draws an additional delay in control periods, uniform from 0 to `jitter`, or DelayLine::kLost.
inline long arrival(const Irregularity& irregularity, long jitter, Draws draws) {
  const bool lost = draws.uniform() < irregularity.dropout;
  const auto more = static_cast<long>(std::floor(draws.uniform() * static_cast<double>(jitter + 1)));
  return lost ? -1 : more < jitter ? more : jitter;
}

/// A delay line with the delay, jitter and losses of one kind of message.
template <class T>
class LateLine {
 public:
  LateLine(double delay, const Irregularity& irregularity, double control_period, const T& prototype,
           BeforeFirst before)
      : irregularity_(irregularity),
        jitter_(delay_steps(irregularity.jitter, control_period)),
        line_(delay_steps(delay, control_period), prototype, before, jitter_) {}

  /// Replaces `value` by the line's output at step k = 0, 1, 2, ... (each once, in order). `draws()` makes the step's
  /// own draws; it is called only if they matter.
  template <class MakeDraws>
  void pass(long k, T& value, MakeDraws draws) {
    if (is_off(irregularity_))
      line_.pass(k, value);
    else
      line_.pass(k, value, arrival(irregularity_, jitter_, draws()));
  }

 private:
  Irregularity irregularity_;
  long jitter_;  // in control periods
  DelayLine<T> line_;
};

}  // namespace moma
