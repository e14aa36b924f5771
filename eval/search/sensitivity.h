#pragma once

#include <string>
#include <vector>

#include "eval/search/evaluator.h"

namespace moma::tune {

struct SensitivitySettings {
  bool enabled = true;
  double near = 0.1;
  double far = 0.25;
  std::size_t pairs_of = 4;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<SensitivitySettings>) {
  using T = SensitivitySettings;
  constexpr Range kStep{0.0, 1.0, true, false};
  v.member("near", &T::near, {.unit = "1", .range = kStep, .text = "small step to both sides, in the unit cube"});
  v.member("far", &T::far, {.unit = "1", .range = kStep, .text = "large step, likewise"});
  v.member("pairs_of", &T::pairs_of,
           {.range = {0, 1000}, .text = "so many of the gains that matter most are also moved two at a time"});
}
inline bool from_word(std::string_view word, SensitivitySettings& settings) {
  return word == "none" && !(settings.enabled = false);
}

/// One gain moved alone from the found values; others stay.
struct SensitivityStep {
  std::size_t variable = 0;
  double value = 0.0;
  double change = 0.0;  ///< of the mean cost, paired over worlds; > 0 is worse
  double error = 0.0;   ///< standard error of that mean
  bool valid = true;
  bool operator==(const SensitivityStep&) const = default;
};

/// Two gains moved together by +-near: what their joint move adds to the sum of the single ones,
/// (f(++) + f(--) - f(+-) - f(-+)) / 4. Positive: they want to be moved in opposite directions.
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

/// Measures around `found` on the search's worlds: 4 candidates per gain and 4 per pair, all through the evaluator
/// (so they are logged, resumed and stored like any other, in phase `sensitivity`, outside the budget).
Sensitivity sensitivity(const SensitivitySettings& settings, const Candidate& found, Evaluator& evaluator);

/// Share of the variance of the candidates' ranks (by merit) that each gain accounts for, over the evaluations of the
/// global phase (over all of the search's where those are too few): ranks are fitted by a sum of one quadratic per
/// gain, y ~ sum_i f_i(u_i), and the share is Cov(f_i, y) / Var(y), less what chance alone would give, never below 0.
/// The shares add up to what the fit explains; the rest is interaction and noise. A search crowds where it is good, so
/// that gains move together: this decomposition divides what they explain jointly, where one gain at a time would
/// count it twice. NaN where there are fewer than three candidates per coefficient.
/// Source: Li et al., J. Phys. Chem. A 114(19), 2010 (structural and correlative sensitivity analysis).
std::vector<double> importance(const std::vector<Variable>& variables, const std::deque<Evaluation>& history);

}  // namespace moma::tune
