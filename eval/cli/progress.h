#pragma once

#include <CLI/CLI.hpp>
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

/// Adds --lost-after of a command whose trials the processes of an mpirun share.
void add_lost_after(CLI::App& command, double& seconds);

/// Runs a command alone or, started by mpirun, as rank 0 of a cluster that `request` then names, or as one of the ranks
/// that compute for it. Returns the exit code of `lead`; of other ranks 0. Throws UsageError without MPI.
int with_ranks(const char* command, run::Request& request, double lost_after, bool profile,
               const std::function<int()>& lead);

/// Prints the saved part of a run that did not finish, and the command that continues it, on stderr. Returns the exit
/// code.
int tell_end(const run::Ended& ended);

}  // namespace moma::cli
