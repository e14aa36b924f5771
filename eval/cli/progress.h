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

/// Progress on stderr: one line that is redrawn on a terminal, a line every few seconds elsewhere.
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

/// A command's computation of trials. While this lives, a signal stops the request. Texts go to stderr, notes only
/// where not `quiet`, warnings as print_warnings() does; progress goes to the status line: "123 of 400 trials, 45.2/s,
/// success 87.0 %, 0:06 left".
class Computation {
 public:
  Computation(run::Request& request, bool quiet);
  StatusLine& line() { return line_; }
  const run::Listener& listener() const { return listener_; }

 private:
  InterruptGuard interrupt_;
  StatusLine line_;
  run::Listener listener_;
};

/// Tells on stderr what is saved of a run that ended early, and how to go on. Returns the exit code.
int stopped_early(const std::string& text);

}  // namespace moma::cli
