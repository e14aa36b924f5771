#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "eval/trial/row.h"

namespace moma::tune {

/// A number that a trial gives: any deterministic numeric column of v_trials by its name, or the name of an outcome
/// (success, collision, timeout, ...; 1 where the trial ended so, else 0).
class Metric {
 public:
  /// Throws std::invalid_argument: unknown (with the nearest name), a text column, or a timing.
  static Metric find(std::string_view name);

  const std::string& name() const { return name_; }
  /// NaN where the trial has no such value (NULL in the store). The same bits from a fresh and from a stored row.
  double value(const TrialRow& row) const;
  /// "" or when the metric is NULL by its nature: "unless the trial succeeds".
  std::string_view null_when() const { return null_when_; }

 private:
  std::string name_;
  std::string_view null_when_;
  std::variant<Outcome, double TrialRow::*, int TrialRow::*> source_ = Outcome::kSuccess;
};

std::vector<std::string> metric_names();

}  // namespace moma::tune
