#pragma once

#include <cstddef>
#include <vector>

namespace moma {

/// What is there before anything that went in comes out.
enum class BeforeFirst { kHoldFirst, kPrototype };

/// Values of consecutive steps, late by a whole number of steps. Allocates when it is made only, as long as assigning
/// a T of the prototype's size does not.
template <typename T>
class DelayLine {
 public:
  DelayLine(long steps, const T& prototype, BeforeFirst before)
      : steps_(steps), before_(before), ring_(steps > 0 ? static_cast<std::size_t>(steps) + 1 : 0, prototype) {}

  /// Replaces the value of step k = 0, 1, 2, ... (each once, in order) by that of step k - `steps`.
  void pass(long k, T& value) {
    if (steps_ == 0) return;
    ring_[slot(k)] = value;
    // What came `steps` before stands in the next slot, which still has the prototype at first; slot 0 has the first
    // value until it is due.
    value = ring_[before_ == BeforeFirst::kHoldFirst && k < steps_ ? 0 : slot(k + 1)];
  }

 private:
  std::size_t slot(long k) const { return static_cast<std::size_t>(k % (steps_ + 1)); }

  long steps_;
  BeforeFirst before_;
  std::vector<T> ring_;
};

}  // namespace moma
