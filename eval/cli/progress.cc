#include "eval/cli/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace moma::cli {
namespace {

using Clock = std::chrono::steady_clock;

int terminal_width() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

std::string duration_text(double seconds) {
  const auto s = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
  if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

std::string describe_progress(const BatchProgress& p, const std::string& what) {
  std::string text = fmt::format("{} of {} trials", p.done, p.total);
  if (p.rate > 0.0) text += fmt::format(", {:.1f}/s", p.rate);
  if (p.done > 0) {
    text += fmt::format(", {} {:.1f} %", what, 100.0 * static_cast<double>(p.successes) / static_cast<double>(p.done));
  }
  if (p.errors > 0) text += fmt::format(", {} {}", p.errors, p.errors == 1 ? "error" : "errors");
  if (p.rate > 0.0 && p.done < p.total) {
    text += fmt::format(", {} left", duration_text(static_cast<double>(p.total - p.done) / p.rate));
  }
  return text;
}

ProgressPrinter::ProgressPrinter(bool quiet, std::string what)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0), what_(std::move(what)), last_(Clock::now()) {}

ProgressPrinter::~ProgressPrinter() { clear(); }

void ProgressPrinter::clear() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

void ProgressPrinter::update(const BatchProgress& p) {
  if (quiet_) return;
  const auto now = Clock::now();
  const auto pause = terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(5000);
  if (now - last_ < pause && p.done < p.total) return;
  last_ = now;
  const std::string text = describe_progress(p, what_);
  if (!terminal_) {
    std::fputs((text + "\n").c_str(), stderr);  // fails without a word where nobody listens
    return;
  }
  const int room = std::clamp(terminal_width() - static_cast<int>(text.size()) - 5, 0, 40);
  const double share = p.total > 0 ? static_cast<double>(p.done) / static_cast<double>(p.total) : 1.0;
  const int filled = static_cast<int>(share * room);
  const std::string bar = room < 5 ? "" : fmt::format("[{:#<{}}{:.<{}}] ", "", filled, "", room - filled);
  std::fputs(fmt::format("\r{}{}\033[K", bar, text).c_str(), stderr);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace moma::cli
