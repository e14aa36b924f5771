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

/// Runs NLopt until it converges or the function says stop; the text says why it ended. An exception from the
/// function ends the run and comes out of here. NLopt's random numbers live in thread-local state that
/// nlopt::srand sets anew here, so a run is a function of its arguments, whatever ran before or runs elsewhere.
std::string run_nlopt(const NloptRun& run, const UnitFunction& function);

}  // namespace moma::tune
