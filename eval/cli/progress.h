#pragma once

#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <string>

#include "eval/batch/batch.h"
#include "eval/run/listener.h"

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

/// How far something is, on stderr: a line that is drawn again on a terminal, a line every few seconds elsewhere.
class StatusLine {
 public:
  explicit StatusLine(bool quiet);
  ~StatusLine() { clear(); }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  /// Asks for the text and shows it, unless the last one was shown a moment ago; `now`: in any case.
  void show(const std::function<std::string()>& text, bool now = false);
  /// Removes the line so that others can be printed.
  void clear();

 private:
  bool quiet_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point last_;
};

/// "1:02:03" or "2:03".
std::string duration_text(double seconds);

/// Texts to stderr, notes only where not `quiet`, warnings as print_warnings() does; progress to `line`, which must
/// live as long: "123 of 400 trials, 45.2/s, success 87.0 %, 0:06 left".
run::Listener listener_on_stderr(bool quiet, StatusLine& line);

}  // namespace moma::cli
