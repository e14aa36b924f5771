#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eval/risk/splitting.h"
#include "eval/run/listener.h"
#include "eval/run/moved_trials.h"
#include "eval/suite/suite.h"
#include "eval/trial/row.h"
#include "eval/tune/trial_cost.h"

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
  /// The metric's value at the event, where the event is one.
  std::optional<double> at() const { return !outcome_ || collision() ? std::optional(value_) : std::nullopt; }
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
  double value_ = 0.0;              ///< VALUE of METRIC<VALUE; clearance of a contact
  std::optional<Outcome> outcome_;  ///< empty: METRIC<VALUE
};

/// Particles of a splitting: moved worlds of one family, with trials of one point.
class TrialParticles final : public risk::Particles {
 public:
  /// All arguments must outlive this object. Particle `i` starts as the family's i-th world.
  TrialParticles(const SuitePoint& at, std::size_t point, std::string family, const RareEvent& event,
                 MovedTrials& trials, const Listener& listener);

  std::size_t kinds() const override { return kinds_; }
  std::vector<double> draw(std::size_t first, std::size_t count) override;
  std::vector<double> propose(std::span<const risk::Proposal> proposals) override;
  void accept(std::size_t i) override;
  void copy(std::size_t from, std::size_t to) override;
  void reached(std::span<const double> levels) override;

  /// Describes a kind of moves in words.
  static const char* name_of_kind(std::size_t kind);
  const std::vector<MovedWorld>& worlds() const { return worlds_; }
  const std::vector<TrialRow>& rows() const { return rows_; }
  /// Returns the family's worlds `first` .. `count` - 1 without moves.
  std::vector<MovedWorld> unmoved(std::size_t first, std::size_t count);

 private:
  std::vector<double> scores(const std::vector<TrialRow>& rows) const;

  const SuitePoint& at_;
  std::size_t point_;
  std::string family_;
  const RareEvent& event_;
  MovedTrials& trials_;
  const Listener& listener_;
  std::size_t kinds_;
  std::vector<std::uint64_t> indices_;  ///< world indices in the family
  std::vector<MovedWorld> worlds_, proposed_;
  std::vector<TrialRow> rows_, proposed_rows_;
  std::vector<std::size_t> places_;  ///< particles of the proposals
};

struct RiskRequest : Request {
  risk::SplittingOptions splitting;
  /// Replicates are added, R at a time and at most to `most`, until the high end of each point's interval is at most
  /// this factor times its low end; empty: R replicates.
  std::optional<double> until;
  std::size_t most = 100;
  std::optional<std::uint64_t> crude;  ///< crude trials of a family; empty: as many as splitting took
};

/// The estimate for one point and one family, or all families joined as strata.
struct RiskRow {
  std::string controller, label;
  std::string family;  ///< "all": joined by the families' weights
  risk::Estimate estimate;
  std::size_t replicates = 0;
  std::size_t trials = 0;  ///< trials of the splitting
  double crude = 0.0;      ///< rate; for "all" weighted over the families
  stats::Interval crude_interval;
  std::size_t crude_trials = 0;
  std::size_t ancestors = 0;  ///< least over the replicates
  std::size_t died = 0;       ///< number of replicates that died out
  std::size_t tied = 0;       ///< most particles that died as ties of a level
  std::vector<std::pair<std::string, risk::Acceptance>> moves;
  std::vector<risk::Exceedance> way;  ///< exceedances on the way to the event
  /// True if the spread over replicates rules out the interval.
  bool refused() const { return estimate.excess() > risk::kRefusedExcess; }
};

struct Risk : Ended {
  std::vector<RiskRow> rows;
  std::vector<std::string> warnings;
};

/// Returns the cost in words: trials of the first draws, of a level, of some probabilities, and their time.
std::string price_of_risk(const RiskRequest& request, const Suite& suite);

/// Estimates the probability of `event` over the worlds and disturbances of the suite, for each of its points, and
/// keeps the rows with the store's invocation. The same rows result for any number of threads and stops. Throws
/// RunError if worlds are not drawn by families, store::StoreError.
Risk estimate_risk(const RiskRequest& request, const Suite& suite, const RareEvent& event,
                   const Listener& listener = {});

}  // namespace moma::run
