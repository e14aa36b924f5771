#pragma once

#include <vector>

#include "eval/search/search.h"

namespace moma::tune {

/// Returns the largest cost of the confirmation in measurements within a quarter of the budget. Drops neighbours, then
/// candidates, until it fits, and stores the rest in `fitted` (0 candidates: no confirmation).
std::uint64_t fit_confirmation(const SearchSettings& settings, Confirmation& fitted);

/// Measures the best few candidates of the history on further worlds, and their neighbours. Best first, never empty.
std::vector<Finalist> confirm(const SearchSettings& settings, const Confirmation& fitted, Evaluator& evaluator);

/// Returns the best fully measured candidates of the search that are at least `apart` from each other in some variable.
std::vector<Evaluation> best_of(const std::vector<Variable>& variables, const std::deque<Evaluation>& history,
                                std::size_t count, double apart);

}  // namespace moma::tune
