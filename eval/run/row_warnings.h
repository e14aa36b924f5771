#pragma once

#include <string>
#include <vector>

#include "eval/trial/row.h"

namespace moma::run {

/// What a run's rows say against its physics, and against what controllers were told of the robot: a person should hear
/// of it without asking.
class RowWarnings {
 public:
  /// `identifies`: the controller goes by the latencies that it finds, so that other ones are no news.
  void look(const TrialRow& row, bool identifies = false);
  /// A sentence for each kind met, with the SQL that lists its trials.
  std::vector<std::string> sentences() const;

 private:
  int contradicted_ = 0, messages_ = 0, errors_ = 0, diverged_ = 0;  // trials
  int latencies_ = 0;
  double deepest_ = 0.0;      // [m]
  double latency_off_ = 0.0;  // the largest, with its sign [s]
};

}  // namespace moma::run
