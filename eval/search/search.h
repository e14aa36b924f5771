#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "eval/search/evaluation.h"
#include "eval/search/evaluator.h"
#include "eval/search/nlopt_run.h"
#include "eval/search/objective.h"
#include "eval/search/sensitivity.h"
#include "eval/search/variables.h"

namespace moma::tune {

/// After the search: the best few candidates are measured on worlds that took no part in it (a score that won a
/// contest is too good on the contest's own worlds), and so are neighbours of each on the search's worlds: of two
/// candidates with equal scores the one whose neighbours do well too is the safer one.
struct Confirmation {
  std::size_t candidates = 5;
  std::size_t worlds = 100;
  std::size_t neighbours = 8;  ///< all variables move by +-radius, with random signs, in pairs
  double radius = 0.04;
};

constexpr void describe(auto& v, Of<Confirmation>) {
  using T = Confirmation;
  v.member("candidates", &T::candidates, in_range({1, 1000}, "", "number of best candidates that are measured again"));
  v.member("worlds", &T::worlds,
           in_range({0, 1'000'000}, "", "number of further worlds; by default that of the search"));
  v.member("neighbours", &T::neighbours,
           in_range({0, 1000}, "", "number of neighbours of each candidate, on the search's worlds"));
  v.member("radius", &T::radius,
           in_range({0.0, 0.5, true, false}, "1", "distance to the neighbours, in the unit cube"));
}
inline bool from_word(std::string_view word, Confirmation& confirmation) {
  if (word != "none") return false;
  confirmation.candidates = confirmation.worlds = confirmation.neighbours = 0;
  return true;
}

/// Settings of a search that a suite chooses.
struct SearchChoices {
  std::vector<Variable> variables;
  std::uint64_t budget = 0;                ///< measurements (trials) of search and confirmation together
  std::vector<const AlgorithmInfo*> plan;  ///< one after the other; a global one that is not the last gets half
                                           ///< of what is left of the budget; empty: default_plan()
  int starts = 1;                          ///< independent searches that share the budget; the first from `start`
  std::uint64_t seed = 1;
  Racing racing;
  Confirmation confirmation;
  SensitivitySettings sensitivity;
};

struct SearchSettings : SearchChoices {
  std::vector<Constraint> constraints;
  std::vector<std::uint64_t> worlds;          ///< worlds of the search
  std::vector<std::uint64_t> confirm_worlds;  ///< other worlds, for the best few
};

/// GN_CRS2_LM for half of the budget, then LN_BOBYQA from the best: the best of the plans tried on noisy test
/// problems of 6 and 12 variables (docs/reference/tuning.md has the table).
std::vector<const AlgorithmInfo*> default_plan();

struct Finalist {
  Candidate candidate;
  double search_merit = 0.0;  ///< on the search's worlds
  double merit = 0.0;         ///< on the search's and the confirming worlds
  double neighbours = 0.0;    ///< mean merit of the neighbours, on the search's worlds; = search_merit without any
  double robust = 0.0;        ///< mean of `merit` and `neighbours`: the smallest is chosen
  std::size_t worlds = 0;
  bool operator==(const Finalist&) const = default;
};

struct RunNote {
  std::string algorithm;
  int start = 0;
  std::uint64_t trials = 0;
  std::size_t evaluations = 0;
  std::string end;  ///< reason of the end
  bool operator==(const RunNote&) const = default;
};

struct SearchResult {
  Candidate found;
  std::vector<Finalist> finalists;  ///< best first
  std::vector<RunNote> runs;
  std::deque<Evaluation> history;
  Sensitivity sensitivity;         ///< around `found`
  std::vector<double> importance;  ///< per variable, over the search
  std::uint64_t trials = 0;        ///< trials of the budget used by search and confirmation
  std::uint64_t trials_saved = 0;  ///< trials saved by racing
  std::uint64_t evaluations_cut = 0;
  double penalty = 0.0;
  std::vector<std::string> notes;  ///< constraints by penalty, gains at a bound, confirmation left out, ...
};

/// Runs the whole search: start, plan, confirmation. Deterministic: the same settings and objective give the same bits
/// whatever the log holds (a log of the same search saves its measurements). Throws std::invalid_argument for
/// contradictory settings, ReplayError, and the exceptions of the objective.
SearchResult search(const SearchSettings& settings, Objective& objective, EvaluationLog& log,
                    const std::function<void(const Progress&)>& progress = {});

}  // namespace moma::tune
