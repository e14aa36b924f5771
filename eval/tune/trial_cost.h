#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "eval/search/objective.h"
#include "eval/suite/suite.h"
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

/// Weight x metric; `when_null` replaces a missing metric.
struct CostTerm {
  Metric metric;
  double weight = 1.0;
  std::optional<double> when_null;
};

/// A bound on a metric's mean over worlds: sign * mean <= sign * bound.
struct MetricBound {
  Metric metric;
  bool at_least = false;
  std::optional<double> bound;  ///< empty: the start's mean in the same worlds
  std::optional<double> when_null;
};

/// A trial lacks a metric of the objective, and no `when_null` replaces it.
class NullMetric : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The cost of a trial. The default objective is an equivalent time in seconds, with L the time limit:
///
///     J = T + 5/3 L * c + 1/6 L * max(0, 1 - m / m_ready)
///
/// T  time_to_goal_s of a success; 2 L of a failure; 4 L after a contact (collision), a fall, a broken simulation or a
///    spilled cup (tipped, diverged, error, spilled): a failure costs at least as much as two of the slowest successes,
///    a collision as much as two failures.
/// c  command_change_mean: mean over steps of the largest |change| / limit. Success alone selects gains that chatter
///    (c = 0.5), which costs 5/6 L, less than the difference between failure and success; smooth gains have 0.02 to
///    0.05. Absent: 1, the worst.
/// m  manip_mean, relative to its value at the robot's `ready`, so that robots of all sizes compare. Absent: 0.
///
/// The alternative is a weighted sum of metrics to minimise.
class TrialCost {
 public:
  /// The default objective.
  TrialCost() = default;
  explicit TrialCost(std::vector<CostTerm> terms) : standard_(false), terms_(std::move(terms)) {}

  /// Quantities of a point that the cost needs besides the row.
  struct Scale {
    double time_limit = 30.0;  ///< L [s]
    double manip_ready = 0.0;  ///< m_ready; 0: without this term
  };
  static Scale scale_of(const SuitePoint& point);

  /// Throws NullMetric.
  double operator()(const TrialRow& row, const Scale& scale) const;
  bool standard() const { return standard_; }
  std::string unit() const { return standard_ ? "s" : ""; }

 private:
  bool standard_ = true;
  std::vector<CostTerm> terms_;
};

/// Returns the constraint's value of one trial (negated for at_least). Throws NullMetric.
double bound_value(const MetricBound& bound, const TrialRow& row);
Constraint constraint_of(const MetricBound& bound);

}  // namespace moma::tune
