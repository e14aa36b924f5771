#include "eval/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

#include "eval/cli/command.h"
#include "eval/cli/suite_options.h"
#include "eval/cli/table.h"
#include "eval/run/evaluate.h"

namespace moma::cli {
namespace {

// A signal handler can reach nothing but a global.
std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void handle(int /*signal*/) { interrupted.store(true, std::memory_order_relaxed); }

}  // namespace

InterruptGuard::InterruptGuard() {
  interrupted.store(false);
  struct sigaction action {};
  action.sa_handler = &handle;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);  // the second signal has its usual effect
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // The terminal is gone; under nohup that is to be ignored.
  sigaction(SIGHUP, nullptr, &hangup_);
  if (hangup_.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  // Nobody reads what is said any more: no reason to lose work.
  struct sigaction ignore {};
  ignore.sa_handler = SIG_IGN;
  sigemptyset(&ignore.sa_mask);
  sigaction(SIGPIPE, &ignore, &pipe_);
}

InterruptGuard::~InterruptGuard() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  sigaction(SIGHUP, &hangup_, nullptr);
  sigaction(SIGPIPE, &pipe_, nullptr);
}

const std::atomic<bool>& InterruptGuard::flag() noexcept { return interrupted; }

namespace {

std::string describe_progress(const BatchProgress& p) {
  std::string text = fmt::format("{} of {} trials", p.done, p.total);
  if (p.rate > 0.0) text += fmt::format(", {:.1f}/s", p.rate);
  if (p.done > 0)
    text += fmt::format(", success {:.1f} %", 100.0 * static_cast<double>(p.successes) / static_cast<double>(p.done));
  if (p.errors > 0) text += fmt::format(", {} {}", p.errors, p.errors == 1 ? "error" : "errors");
  if (p.rate > 0.0 && p.done < p.total)
    text += fmt::format(", {} left", duration_text(static_cast<double>(p.total - p.done) / p.rate));
  return text;
}

}  // namespace

StatusLine::StatusLine(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0), last_(std::chrono::steady_clock::now()) {}

void StatusLine::show(const std::function<std::string()>& text, bool now) {
  if (quiet_) return;
  const auto time = std::chrono::steady_clock::now();
  if (!now && time - last_ < std::chrono::milliseconds(terminal_ ? 200 : 5000)) return;
  last_ = time;
  // An error is ignored: standard error may be closed.
  std::fputs((terminal_ ? "\r" + text() + "\033[K" : text() + "\n").c_str(), stderr);
  std::fflush(stderr);
  drawn_ = terminal_;
}

void StatusLine::clear() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

std::string duration_text(double seconds) {
  const auto s = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
  if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

Computation::Computation(run::Request& request, bool quiet) : line_(quiet) {
  request.stop = &InterruptGuard::flag();
  const auto say = [](const std::string& text) { std::cerr << terminal_safe_lines(text) << std::endl; };
  if (!quiet) listener_.note = say;
  listener_.notice = say;
  listener_.warning = [](const std::string& text) { print_warnings({text}); };
  listener_.progress = [this](const BatchProgress& p) {
    line_.show([&] { return describe_progress(p); }, p.done >= p.total);
  };
  listener_.progress_end = [this] { line_.clear(); };
}

void add_lost_after(CLI::App& command, double& seconds) {
  command.add_option("--lost-after", seconds, "Seconds of silence after which an MPI rank is given up (30)")
      ->check(CLI::Range(0.1, 1e6));
}

int with_ranks(const char* command, run::Request& request, double lost_after, bool profile,
               const std::function<int()>& lead) {
  if (Cluster::launched() == 1) return lead();
  if (!Cluster::built()) {
    throw UsageError(fmt::format(
        "{}: started by mpirun, but this moma was built without MPI, so that every process would compute everything; "
        "install libopenmpi-dev and build again, or use the --shard of moma run",
        command));
  }
  Cluster cluster(lost_after);
  request.cluster = &cluster;
  if (cluster.rank() == 0) return lead();
  const InterruptGuard interrupt;  // a signal reaches every rank; rank 0 decides what becomes of it
  run::follow(cluster, request.threads, profile);
  return kOk;
}

int tell_end(const run::Ended& ended) {
  if (!ended.stopped.empty()) std::cerr << terminal_safe_lines(ended.stopped) << std::endl;
  if (ended.end == run::End::kFinished) return kOk;
  return ended.end == run::End::kSameError ? kCheckFailed : kStoppedEarly;
}

}  // namespace moma::cli
