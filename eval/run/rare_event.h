#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "eval/trial/row.h"
#include "eval/tune/metric.h"

namespace moma::run {

/// An event that a trial may be, and how near it came to it.
class RareEvent {
 public:
  /// An outcome (collision, timeout, stuck, joint_limit, infeasible), whose nearness is a metric of its own, or
  /// METRIC<VALUE or METRIC>VALUE. Throws std::invalid_argument, naming what there is.
  static RareEvent read(std::string_view text);

  const std::string& text() const { return text_; }
  /// The metric by which trials are sorted.
  const std::string& level() const { return level_.name(); }
  bool collision() const { return outcome_.value_or(Outcome::kSuccess) == Outcome::kCollision; }
  bool happened(const TrialRow& row) const;
  /// risk::kEvent where it happened; else the greater the nearer, -infinity without a value or by an error.
  double score(const TrialRow& row) const;
  /// The metric's value of a finite score.
  double value_of(double score) const { return sign_ * score; }

 private:
  RareEvent(std::string_view text, tune::Metric level, double sign)
      : text_(text), level_(std::move(level)), sign_(sign) {}

  std::string text_;
  tune::Metric level_;
  double sign_;                     ///< -1: less is nearer
  double value_ = 0.0;              ///< of METRIC<VALUE
  std::optional<Outcome> outcome_;  ///< none: METRIC<VALUE
};

}  // namespace moma::run
