#pragma once

#include <atomic>
#include <csignal>

namespace moma::cli {

/// While it lives, the first SIGINT, SIGTERM or SIGHUP (unless that is ignored, as under nohup) sets the flag; a second
/// one ends the program at once, as usual. A pipe that nobody reads any more ends nothing.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;
  static const std::atomic<bool>& flag() noexcept;

 private:
  struct sigaction hangup_ {};
  struct sigaction pipe_ {};
};

}  // namespace moma::cli
