#include "eval/tune/metric.h"

#include <fmt/format.h>

#include <stdexcept>

#include "controller/config/node.h"
#include "eval/store/columns.h"

namespace moma::tune {
std::vector<std::string> metric_names() {
  std::vector<std::string> names;
  for (const std::string_view outcome : words(Of<Outcome>{})) names.emplace_back(outcome);
  for (const store::TrialColumn& column : store::trial_columns()) {
    if (!std::holds_alternative<std::string TrialRow::*>(column.member)) names.emplace_back(column.name);
  }
  return names;
}

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

}  // namespace moma::tune
