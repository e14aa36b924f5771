#include "eval/tune/metric.h"

#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <utility>

#include "controller/config/node.h"
#include "eval/store/columns.h"

namespace moma::tune {
namespace {

constexpr std::array kOutcomes{Outcome::kSuccess,    Outcome::kCollision,  Outcome::kTimeout,
                               Outcome::kStuck,      Outcome::kJointLimit, Outcome::kTipped,
                               Outcome::kInfeasible, Outcome::kDiverged,   Outcome::kError};

// Metrics that some healthy trials do not have. Others are NULL only where a trial ended before its first step.
constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kOftenNull{{
    {"time_to_goal_s", "unless the trial succeeds"},
    {"collision_time_s", "unless the trial has a collision"},
    {"collision_depth_m", "unless the trial has a collision"},
    {"clearance_min_m", "in a world without objects"},
    {"energy_j", "in kinematic mode"},
}};

}  // namespace

std::vector<std::string> metric_names() {
  std::vector<std::string> names;
  for (const Outcome outcome : kOutcomes) names.emplace_back(to_string(outcome));
  for (const store::TrialColumn& column : store::trial_columns()) {
    if (!std::holds_alternative<std::string TrialRow::*>(column.member)) names.emplace_back(column.name);
  }
  return names;
}

Metric Metric::find(std::string_view name) {
  Metric metric;
  metric.name_ = std::string(name);
  for (const Outcome outcome : kOutcomes) {
    if (to_string(outcome) == name) {
      metric.source_ = outcome;
      return metric;
    }
  }
  for (const store::TrialColumn& column : store::trial_columns()) {
    if (name != column.name) continue;
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
  const std::string near = config::nearest(name, known);
  throw std::invalid_argument(fmt::format("unknown metric '{}'{}; known are {}", name,
                                          near.empty() ? "" : fmt::format(" (did you mean {}?)", near),
                                          fmt::join(known, ", ")));
}

double Metric::value(const TrialRow& row) const {
  if (const auto* outcome = std::get_if<Outcome>(&source_)) return row.outcome == *outcome ? 1.0 : 0.0;
  if (const auto* number = std::get_if<double TrialRow::*>(&source_)) return store::stored(row.*(*number));
  return static_cast<double>(row.*std::get<int TrialRow::*>(source_));
}

std::string_view Metric::null_when() const {
  for (const auto& [name, when] : kOftenNull) {
    if (name == name_) return when;
  }
  return {};
}

}  // namespace moma::tune
