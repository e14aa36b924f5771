#pragma once

#include <string>
#include <vector>

#include "eval/trial/row.h"

namespace moma::run {

/// Finds contradictions between a run's rows and its physics, and between rows and the robot description of the
/// controllers, for warnings without a request.
class RowWarnings {
 public:
  /// `identifies`: the controller uses identified latencies, so that deviating latencies need no warning.
  void look(const TrialRow& row, bool identifies = false);
  /// Returns a sentence for each kind of contradiction, with the SQL that lists its trials.
  std::vector<std::string> sentences() const;

 private:
  int contradicted_ = 0, messages_ = 0, errors_ = 0, diverged_ = 0;  // numbers of trials
  int latencies_ = 0;
  double deepest_ = 0.0;      // [m]
  double latency_off_ = 0.0;  // the largest, with its sign [s]
};

}  // namespace moma::run
