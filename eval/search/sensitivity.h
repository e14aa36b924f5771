#pragma once

#include <vector>

#include "eval/search/evaluator.h"

namespace moma::tune {

struct SensitivitySettings {
  bool enabled = true;
  double near = 0.1;
  double far = 0.25;
  std::size_t pairs_of = 4;
};

constexpr void describe(auto& v, Of<SensitivitySettings>) {
  using T = SensitivitySettings;
  constexpr Range kStep{0.0, 1.0, true, false};
  v.member("near", &T::near, in_range(kStep, "1", "small step in both directions, in the unit cube"));
  v.member("far", &T::far, in_range(kStep, "1", "large step in both directions"));
  v.member("pairs_of", &T::pairs_of,
           in_range({0, 1000}, "", "number of most influential gains that also move in pairs"));
}
inline bool from_word(std::string_view word, SensitivitySettings& settings) {
  return word == "none" && !(settings.enabled = false);
}

/// A change of one gain alone from the found values.
struct SensitivityStep {
  std::size_t variable = 0;
  double value = 0.0;
  double change = 0.0;  ///< change of the mean cost, paired over worlds; > 0 is worse
  double error = 0.0;   ///< standard error of `change`
  bool valid = true;
  bool operator==(const SensitivityStep&) const = default;
};

/// A change of two gains together by +-near: the interaction beyond the sum of single changes, (f(++) + f(--) - f(+-) -
/// f(-+)) / 4. A positive value means that they should move in opposite directions.
struct SensitivityPair {
  std::size_t first = 0;
  std::size_t second = 0;
  double interaction = 0.0;
  double error = 0.0;
  bool operator==(const SensitivityPair&) const = default;
};

struct Sensitivity {
  std::vector<SensitivityStep> steps;
  std::vector<SensitivityPair> pairs;
  bool operator==(const Sensitivity&) const = default;
};

/// Measures around `found` on the search's worlds: 4 candidates per gain and 4 per pair. The evaluator logs, resumes
/// and stores them like any other, in phase `sensitivity`, outside the budget.
Sensitivity sensitivity(const SensitivitySettings& settings, const Candidate& found, Evaluator& evaluator);

/// Returns the share of the variance of the candidates' ranks (by merit) that each gain explains, over the evaluations
/// of the global phase (or over the whole search if those are too few). The ranks are fitted by a sum of one quadratic
/// per gain, y ~ sum_i f_i(u_i). The share is Cov(f_i, y) / Var(y) minus the expectation by chance, and never below 0.
/// The shares add up to the explained variance; the rest is interaction and noise. Candidates crowd in good regions, so
/// that gains are correlated: this decomposition splits their joint contribution, which single-gain measures would
/// count twice. NaN for fewer than three candidates per coefficient. Source: Li et al., J. Phys. Chem. A 114(19), 2010
/// (structural and correlative sensitivity analysis).
std::vector<double> importance(const std::vector<Variable>& variables, const std::deque<Evaluation>& history);

}  // namespace moma::tune
