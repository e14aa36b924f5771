#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "eval/risk/splitting.h"
#include "eval/run/listener.h"
#include "eval/run/moved_trials.h"
#include "eval/run/rare_event.h"
#include "eval/suite/suite.h"

namespace moma::run {

/// Particles of a splitting that are worlds of one family, moved, with one point's trials in them.
class TrialParticles final : public risk::Particles {
 public:
  /// All have to outlive this. Particle `i` begins as the family's i-th world.
  TrialParticles(const SuitePoint& at, std::size_t point, std::string family, const RareEvent& event,
                 MovedTrials& trials, const Listener& listener);

  std::size_t kinds() const override { return kinds_; }
  std::vector<double> draw(std::size_t count) override;
  std::vector<double> propose(std::span<const risk::Proposal> proposals) override;
  void accept(std::size_t i) override;
  void copy(std::size_t from, std::size_t to) override;
  void reached(std::span<const double> levels) override;

  /// What a kind of moves moves, in words.
  static const char* name_of_kind(std::size_t kind);
  const std::vector<MovedWorld>& worlds() const { return worlds_; }
  const std::vector<TrialRow>& rows() const { return rows_; }
  /// The family's worlds `first` .. `count` - 1, unmoved.
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
  std::vector<std::uint64_t> indices_;  ///< of the family
  std::vector<MovedWorld> worlds_, proposed_;
  std::vector<TrialRow> rows_, proposed_rows_;
  std::vector<std::size_t> places_;  ///< of the proposals
};

struct RiskRequest {
  MovedTrialsRequest trials;
  risk::SplittingOptions splitting;
  std::optional<std::uint64_t> crude;  ///< crude trials of a family; none: as many as splitting took
};

/// One family of worlds, or all joined as strata, of one point.
struct RiskRow {
  std::string controller, label;
  std::string family;  ///< "all": joined by the families' weights
  risk::Estimate estimate;
  std::size_t trials = 0;  ///< that the splitting asked for
  double crude = 0.0;      ///< rate; of all families by their weights
  stats::Interval crude_interval;
  std::size_t crude_trials = 0;
  std::size_t ancestors = 0;  ///< fewest of a replicate
  std::size_t died = 0;       ///< replicates that died out
  std::size_t tied = 0;       ///< most particles that died as ties of a level's middle
  std::vector<std::pair<std::string, risk::Acceptance>> moves;
  /// The spread over replicates shows that the interval cannot be believed.
  bool refused() const { return estimate.excess() > risk::kRefusedExcess; }
};

struct Risk {
  End end = End::kFinished;
  std::string stopped;  ///< where it did not finish: what is saved and how to go on
  std::vector<RiskRow> rows;
  std::vector<std::string> warnings;
};

/// The price in words, before it is paid: trials of the first draws, of a level, of some probabilities, and their time.
std::string price_of_risk(const RiskRequest& request, const Suite& suite);

/// Estimates how probable `event` is over the worlds and disturbances of the suite, for each of its points. The same
/// rows come out whatever the number of threads and stops. Throws RunError where worlds are not drawn by families,
/// store::StoreError.
Risk estimate_risk(const RiskRequest& request, const Suite& suite, const RareEvent& event,
                   const Listener& listener = {});

}  // namespace moma::run
