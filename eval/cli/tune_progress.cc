#include "eval/cli/tune_progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace moma::cli {

TuneProgress::TuneProgress(bool quiet, std::string unit)
    : quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) != 0),
      unit_(std::move(unit)),
      begin_(std::chrono::steady_clock::now()),
      last_(begin_) {}

void TuneProgress::trial() {
  ++computed_;
  ++since_update_;
  show();
}

void TuneProgress::update(const tune::Progress& p) {
  if (evaluations_ == 0 && p.last != nullptr) start_ = p.last->merit;
  if (p.phase == tune::Phase::kSensitivity && phase_ != p.phase) searched_ = trials_;
  phase_ = p.phase;
  trials_ = p.trials;
  budget_ = p.budget;
  evaluations_ = p.evaluations;
  cut_ = p.cut;
  if (p.best != nullptr) best_ = p.best->merit;
  since_update_ = 0;
  show();
}

std::string TuneProgress::text() const {
  const std::uint64_t done = trials_ + since_update_;
  std::string text = phase_ == tune::Phase::kSensitivity
                         ? fmt::format("sensitivity: {} trials after the search", done - searched_)
                         : fmt::format("{}: {} of {} trials", to_string(phase_), done, budget_);
  if (evaluations_ > 0) {
    text += fmt::format(", {} candidates ({} cut short), best {:.4g}{} (start {:.4g})", evaluations_, cut_, best_,
                        unit_.empty() ? "" : " " + unit_, start_);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  if (computed_ > 0 && seconds > 0.0) {
    const double rate = static_cast<double>(computed_) / seconds;
    text += fmt::format(", {:.1f}/s", rate);
    if (phase_ != tune::Phase::kSensitivity && budget_ > done) {
      const auto left = static_cast<long long>(static_cast<double>(budget_ - done) / rate) + 1;
      text += fmt::format(", {}:{:02}:{:02} left", left / 3600, left / 60 % 60, left % 60);
    }
  }
  return text;
}

void TuneProgress::show() {
  if (quiet_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < (terminal_ ? std::chrono::milliseconds(200) : std::chrono::milliseconds(10000))) return;
  last_ = now;
  if (terminal_) {
    std::fputs(fmt::format("\r{}\033[K", text()).c_str(), stderr);
    std::fflush(stderr);
    drawn_ = true;
  } else {
    std::fputs((text() + "\n").c_str(), stderr);
  }
}

void TuneProgress::clear() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

}  // namespace moma::cli
