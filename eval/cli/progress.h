#pragma once

#include <chrono>
#include <string>

#include "eval/batch/batch.h"

namespace moma::cli {

/// How far a batch is, on stderr: a bar that is drawn again on a terminal, a line every few seconds elsewhere.
class ProgressPrinter {
 public:
  /// `what`: the word for the running rate, e.g. "success".
  ProgressPrinter(bool quiet, std::string what);
  /// Clears a bar that is still there.
  ~ProgressPrinter();
  ProgressPrinter(const ProgressPrinter&) = delete;
  ProgressPrinter& operator=(const ProgressPrinter&) = delete;

  void update(const BatchProgress& progress);
  /// Removes the bar so that other lines can be printed.
  void clear();

 private:
  bool quiet_;
  bool terminal_;
  bool drawn_ = false;
  std::string what_;
  std::chrono::steady_clock::time_point last_;
};

/// "1:02:03" or "2:03".
std::string duration_text(double seconds);

/// "123 of 400 trials, 45.2/s, success 87.0 %, 0:06 left".
std::string describe_progress(const BatchProgress& progress, const std::string& what);

}  // namespace moma::cli
