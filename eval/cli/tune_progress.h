#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "eval/search/evaluator.h"

namespace moma::cli {

/// How far a search is, on stderr: one line that is drawn again on a terminal, a line every few seconds elsewhere.
class TuneProgress {
 public:
  TuneProgress(bool quiet, std::string unit);
  ~TuneProgress() { clear(); }
  TuneProgress(const TuneProgress&) = delete;
  TuneProgress& operator=(const TuneProgress&) = delete;

  /// A trial was computed.
  void trial();
  /// An evaluation ended.
  void update(const tune::Progress& progress);
  void clear();

 private:
  void show();
  std::string text() const;

  bool quiet_;
  bool terminal_;
  bool drawn_ = false;
  std::string unit_;
  std::chrono::steady_clock::time_point begin_, last_;
  std::uint64_t computed_ = 0;
  std::uint64_t since_update_ = 0;
  tune::Phase phase_ = tune::Phase::kStart;
  std::uint64_t trials_ = 0, searched_ = 0, budget_ = 0, evaluations_ = 0, cut_ = 0;
  double start_ = 0.0, best_ = 0.0;
};

}  // namespace moma::cli
