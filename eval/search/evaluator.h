#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "controller/describe/describe.h"
#include "eval/search/evaluation.h"
#include "eval/search/objective.h"
#include "eval/search/variables.h"

namespace moma::tune {

/// Racing cuts a candidate after a block of worlds if its mean cost on the worlds so far exceeds the incumbent's on the
/// same worlds, and the paired one-sided Wilcoxon signed-rank test confirms that with p < `significance`. The rank test
/// alone would cut a candidate that is slightly slower in most worlds but succeeds in a few more. The incumbent is the
/// best fully measured candidate, by merit.
struct Racing {
  bool enabled = true;
  std::size_t first = 10;
  std::size_t block = 10;
  double significance = 0.01;
};

constexpr void describe(auto& v, Of<Racing>) {
  using T = Racing;
  v.member("first", &T::first, in_range({2, 1'000'000}, "", "number of worlds before the first test"));
  v.member("block", &T::block, in_range({1, 1'000'000}, "", "number of worlds between two tests"));
  v.member("significance", &T::significance,
           in_range({0.0, 0.5, true, false}, "1", "significance of the rank test, per test"));
}
inline bool from_word(std::string_view word, Racing& racing) { return word == "none" && !(racing.enabled = false); }

struct SearchSettings;  // eval/search/search.h

/// The state of the search, for display.
struct Progress {
  Phase phase = Phase::kStart;
  std::uint64_t evaluations = 0;
  std::uint64_t cut = 0;
  std::uint64_t trials = 0;  ///< number of trials used of `budget`
  std::uint64_t budget = 0;
  const Evaluation* last = nullptr;
  const Evaluation* best = nullptr;  ///< best fully measured candidate, null before the first
};

/// Measures candidates, with memory, racing, budget and log, in shuffled worlds: those of the search, which make a full
/// score, then those of the confirmation. All results are functions of the settings and the sequence of calls, never of
/// time, threads or the log's contents.
class Evaluator {
 public:
  /// The arguments must outlive this object. Throws std::invalid_argument for an objective of another width.
  Evaluator(const SearchSettings& settings, Objective& objective, EvaluationLog& log,
            std::function<void(const Progress&)> progress = {});

  /// Returns a full or cut score on the search's worlds. A known candidate is answered from memory and logs nothing.
  const Evaluation& score(const Candidate& candidate, Phase phase, int run);
  /// Measures the first `count` worlds of the order, without racing.
  const Evaluation& extend(const Candidate& candidate, std::size_t count, Phase phase);

  bool knows(const Candidate& candidate) const { return known_.contains(candidate); }
  std::uint64_t trials() const { return trials_; }
  /// Measurements saved by cutting so far.
  std::uint64_t trials_saved() const { return saved_; }
  const Evaluation* best() const { return best_ < 0 ? nullptr : &history_[static_cast<std::size_t>(best_)]; }
  const std::deque<Evaluation>& history() const { return history_; }
  const SearchSettings& settings() const { return settings_; }
  /// Cost per world of a candidate, in the order of the worlds.
  std::vector<double> costs(const Candidate& candidate) const;
  /// Merit per violation: the size of the start's cost, at least 1.
  double penalty() const { return penalty_; }
  /// Sum of the constraints' relative excesses: max(0, mean - bound) / max(|bound|, 0.01). A bound by the start is the
  /// start's own mean on the search's worlds.
  double violation(std::span<const double> constraint_means) const;

 private:
  struct Known {
    std::vector<double> values;  ///< worlds x width
    std::size_t latest = 0;      ///< index of its latest evaluation in the history
  };
  struct Begun {
    Evaluation evaluation;
    std::optional<Evaluation> stored;  ///< its entry in the log
  };
  /// Appends an evaluation to the history without measurements; `first` worlds are known before. Cut if invalid.
  Begun begin(const Candidate& candidate, Phase phase, int run, std::size_t first);
  bool race_lost(const Known& known, std::size_t worlds) const;
  void summarise(Evaluation& evaluation, const std::vector<double>& values);
  /// Mean difference of value k + 1 to the start's, over the search's worlds that both have met.
  double above_start(std::size_t k, const std::vector<double>& values) const;
  double penalised(const Evaluation& evaluation) const;
  void estimate(Evaluation& evaluation) const;
  const Evaluation& conclude(Evaluation evaluation, Known& known, const Evaluation* stored);
  std::optional<Evaluation> logged(const Evaluation& begun);
  void take(Evaluation& evaluation, Known& known, std::size_t count, const std::optional<Evaluation>& stored);

  const SearchSettings& settings_;
  std::vector<std::uint64_t> worlds_;  // in the order of measurement
  Objective& objective_;
  EvaluationLog& log_;
  std::function<void(const Progress&)> report_;
  std::map<Candidate, Known> known_;
  std::deque<Evaluation> history_;  // references to evaluations stay valid
  long long best_ = -1;
  std::uint64_t trials_ = 0;
  std::uint64_t saved_ = 0;
  std::uint64_t cuts_ = 0;
  double penalty_ = 1.0;
  std::vector<double> scales_;  // scales of the constraints' excesses
};

}  // namespace moma::tune
