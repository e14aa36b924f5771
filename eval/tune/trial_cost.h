#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "eval/search/objective.h"
#include "eval/suite/suite.h"
#include "eval/trial/row.h"
#include "eval/tune/metric.h"

namespace moma::tune {

/// weight x metric; `when_null` stands for the metric where a trial has none.
struct CostTerm {
  Metric metric;
  double weight = 1.0;
  std::optional<double> when_null;
};

/// A metric's mean over worlds is bounded: sign * mean <= sign * bound.
struct MetricBound {
  Metric metric;
  bool at_least = false;
  std::optional<double> bound;  ///< none: what the search's start has in the same worlds
  std::optional<double> when_null;
};

/// A trial has no value for a metric of the objective, and no `when_null` says what to take.
class NullMetric : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a trial costs. The default objective is in seconds, "the time that this trial is worth", with L the time limit:
///
///     J = T + 5/3 L * c + 1/6 L * max(0, 1 - m / m_ready)
///
/// T  time_to_goal_s of a success; 2 L of a failure; 4 L where something was touched (collision), the robot fell or
///    the simulation broke (tipped, diverged, error): a failure costs at least as much as two of the slowest successes,
///    a collision as much as two failures.
/// c  command_change_mean: mean over steps of the largest |change| / limit. Success alone picks gains that chatter
///    (c = 0.5), which costs 5/6 L, less than what a failure costs beyond a success; smooth gains have 0.02 to 0.05.
///    Absent: 1, the worst.
/// m  manip_mean, against its value in the robot's `ready` pose, so that robots of all sizes compare. Absent: 0.
///
/// Or a weighted sum of metrics, to be made small.
class TrialCost {
 public:
  /// The default objective.
  TrialCost() = default;
  explicit TrialCost(std::vector<CostTerm> terms) : standard_(false), terms_(std::move(terms)) {}

  /// What the cost needs to know about a point besides the row.
  struct Scale {
    double time_limit = 30.0;  ///< L [s]
    double manip_ready = 0.0;  ///< m_ready; 0: the term is left out
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

/// The constraint's value of one trial (negated for at_least). Throws NullMetric.
double bound_value(const MetricBound& bound, const TrialRow& row);
Constraint constraint_of(const MetricBound& bound);

}  // namespace moma::tune
