#pragma once

#include <atomic>

namespace moma::cli {

/// While it lives, the first SIGINT or SIGTERM sets the flag; a second one ends the program at once, as usual.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  static const std::atomic<bool>& flag() noexcept;
};

}  // namespace moma::cli
