#pragma once

#include <vector>

#include "eval/search/search.h"

namespace moma::tune {

/// What the confirmation costs at most, in measurements, when it may use a quarter of the budget: neighbours, then
/// candidates are given up until it fits. `fitted` gets what is left (0 candidates: none at all).
std::uint64_t fit_confirmation(const SearchSettings& settings, Confirmation& fitted);

/// Measures the best few of the history further, and their neighbours. Best first, never empty.
std::vector<Finalist> confirm(const SearchSettings& settings, const Confirmation& fitted, Evaluator& evaluator);

/// The best fully measured candidates of the search, at least `apart` from each other in some variable.
std::vector<Evaluation> best_of(const std::vector<Variable>& variables, const std::deque<Evaluation>& history,
                                std::size_t count, double apart);

}  // namespace moma::tune
