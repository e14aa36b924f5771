#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "eval/trial/row.h"

namespace moma::tune {

/// A number of a trial: any deterministic numeric column of v_trials by its name, or the name of an outcome (success,
/// collision, timeout, ...; 1 if the trial ended so, else 0).
class Metric {
 public:
  /// Throws std::invalid_argument for an unknown name (with the nearest one), a text column, or a timing.
  static Metric find(std::string_view name);

  const std::string& name() const { return name_; }
  /// NaN if the trial has no such value (NULL in the store). A stored row gives the same bits as a fresh one.
  double value(const TrialRow& row) const;
  /// "" or the condition under which the metric is NULL: "unless the trial succeeds".
  std::string_view null_when() const { return null_when_; }

 private:
  std::string name_;
  std::string_view null_when_;
  std::variant<Outcome, double TrialRow::*, int TrialRow::*> source_ = Outcome::kSuccess;
};

std::vector<std::string> metric_names();

}  // namespace moma::tune
