#include "eval/tune/trial_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controller/config/node.h"
#include "controller/model/kinematics.h"
#include "controller/model/manipulability.h"
#include "eval/store/columns.h"

namespace moma::tune {

namespace {

std::vector<std::string> metric_names() {
  std::vector<std::string> names;
  for (const std::string_view outcome : words(Of<Outcome>{})) names.emplace_back(outcome);
  for (const store::TrialColumn& column : store::trial_columns()) {
    if (!std::holds_alternative<std::string TrialRow::*>(column.member)) names.emplace_back(column.name);
  }
  return names;
}

}  // namespace

Metric Metric::find(std::string_view name) {
  Metric metric;
  metric.name_ = std::string(name);
  if (const auto outcome = from_string<Outcome>(name)) {
    metric.source_ = *outcome;
    return metric;
  }
  for (const store::TrialColumn& column : store::trial_columns()) {
    if (name != column.name) continue;
    metric.null_when_ = column.about.null_when;
    if (const auto* number = std::get_if<double TrialRow::*>(&column.member)) {
      metric.source_ = *number;
    } else if (const auto* count = std::get_if<int TrialRow::*>(&column.member)) {
      metric.source_ = *count;
    } else {
      throw std::invalid_argument(fmt::format("metric {} is text; a number is needed", name));
    }
    return metric;
  }
  for (const store::TimingColumn& column : store::timing_columns()) {
    if (name == column.name) {
      throw std::invalid_argument(fmt::format(
          "metric {} is a timing: it differs from run to run, so that a search by it could not be repeated", name));
    }
  }
  const std::vector<std::string> known = metric_names();
  throw std::invalid_argument(fmt::format("unknown metric '{}'{}; known are {}", name, config::suggestion(name, known),
                                          fmt::join(known, ", ")));
}

double Metric::value(const TrialRow& row) const {
  if (const auto* outcome = std::get_if<Outcome>(&source_)) return row.outcome == *outcome ? 1.0 : 0.0;
  if (const auto* number = std::get_if<double TrialRow::*>(&source_)) return store::stored(row.*(*number));
  return static_cast<double>(row.*std::get<int TrialRow::*>(source_));
}

namespace {

constexpr double kFailureLimits = 2.0;  // cost of a failure in time limits
constexpr double kBreakageLimits = 4.0;
// The weight is proportional to the time limit, as for failures: with a short limit smoothness would cost more than
// success.
constexpr double kLimitsPerChange = 5.0 / 3.0;
constexpr double kLimitsForManip = 1.0 / 6.0;  // for the loss of all manipulability

double value_or(const Metric& metric, const std::optional<double>& when_null, const TrialRow& row) {
  const double value = metric.value(row);
  if (!std::isnan(value)) return value;
  if (when_null) return *when_null;
  throw NullMetric(fmt::format("{} is NULL for a trial with outcome {}: give a replacement as when_null", metric.name(),
                               to_string(row.outcome)));
}

double default_cost(const TrialRow& row, const TrialCost::Scale& scale) {
  double cost = 0.0;
  switch (row.outcome) {
    case Outcome::kSuccess:
      cost = store::stored(row.time_to_goal_s);
      break;
    case Outcome::kTimeout:
    case Outcome::kStuck:
    case Outcome::kJointLimit:
    case Outcome::kInfeasible:
      cost = kFailureLimits * scale.time_limit;
      break;
    case Outcome::kCollision:
    case Outcome::kTipped:
    case Outcome::kDiverged:
    case Outcome::kSpilled:
    case Outcome::kError:
      cost = kBreakageLimits * scale.time_limit;
      break;
  }
  const double change = store::stored(row.command_change_mean);
  cost += kLimitsPerChange * scale.time_limit * (std::isnan(change) ? 1.0 : change);
  if (scale.manip_ready > 0.0) {
    const double manip = store::stored(row.manip_mean);
    cost +=
        kLimitsForManip * scale.time_limit * std::max(0.0, 1.0 - (std::isnan(manip) ? 0.0 : manip) / scale.manip_ready);
  }
  return cost;
}

}  // namespace

TrialCost::Scale TrialCost::scale_of(const SuitePoint& point) {
  Scale scale;
  scale.time_limit = point.simulation.time_limit;
  const std::shared_ptr<const RobotModel>& model = point.robot->model;
  const Kinematics kinematics(model);  // at `ready`
  scale.manip_ready =
      manipulability(kinematics.J_WE_W().rightCols(model->num_joints()), ManipulabilityRows::kTranslation);
  return scale;
}

double TrialCost::operator()(const TrialRow& row, const Scale& scale) const {
  if (standard_) return default_cost(row, scale);
  double sum = 0.0;
  for (const CostTerm& term : terms_) sum += term.weight * value_or(term.metric, term.when_null, row);
  return sum;
}

double bound_value(const MetricBound& bound, const TrialRow& row) {
  const double value = value_or(bound.metric, bound.when_null, row);
  return bound.at_least ? -value : value;
}

Constraint constraint_of(const MetricBound& bound) {
  const std::string name = fmt::format("{} {} ", bound.metric.name(), bound.at_least ? ">=" : "<=");
  if (!bound.bound) return {name + "the start's", 0.0, true};
  return {fmt::format("{}{}", name, *bound.bound), bound.at_least ? -*bound.bound : *bound.bound};
}

}  // namespace moma::tune
