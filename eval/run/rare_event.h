#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "eval/trial/row.h"
#include "eval/tune/metric.h"

namespace moma::run {

/// An event that a trial can be, with a score of nearness.
class RareEvent {
 public:
  /// Reads an outcome (collision, timeout, stuck, joint_limit, infeasible), whose score is a metric of its own, or
  /// METRIC<VALUE or METRIC>VALUE. Throws std::invalid_argument with the accepted names.
  static RareEvent read(std::string_view text);

  const std::string& text() const { return text_; }
  /// Name of the metric that sorts the trials.
  const std::string& level() const { return level_.name(); }
  bool collision() const { return outcome_.value_or(Outcome::kSuccess) == Outcome::kCollision; }
  bool happened(const TrialRow& row) const;
  /// Returns risk::kEvent if the event happened; otherwise a score that increases with nearness, -infinity without a
  /// value or after an error.
  double score(const TrialRow& row) const;
  /// Returns the metric's value for a finite score.
  double value_of(double score) const { return sign_ * score; }

 private:
  RareEvent(std::string_view text, tune::Metric level, double sign)
      : text_(text), level_(std::move(level)), sign_(sign) {}

  std::string text_;
  tune::Metric level_;
  double sign_;                     ///< -1: smaller values are nearer
  double value_ = 0.0;              ///< VALUE of METRIC<VALUE
  std::optional<Outcome> outcome_;  ///< empty: METRIC<VALUE
};

}  // namespace moma::run
