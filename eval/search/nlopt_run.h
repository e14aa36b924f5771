#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/search/algorithms.h"

namespace moma::tune {

/// The function to minimise, on the unit cube. None: stop now (the budget is spent).
using UnitFunction = std::function<std::optional<double>(std::span<const double> unit)>;

struct NloptRun {
  const AlgorithmInfo* algorithm = nullptr;
  std::vector<double> start;   ///< in the unit cube
  std::uint64_t seed = 0;      ///< for nlopt::srand
  std::size_t population = 0;  ///< 0: NLopt's own
};

/// Runs NLopt until it converges or the function stops it; returns the reason of the end. An exception of the function
/// ends the run and leaves this function. nlopt::srand resets NLopt's thread-local random state here, so that a run is
/// a function of its arguments.
std::string run_nlopt(const NloptRun& run, const UnitFunction& function);

}  // namespace moma::tune
