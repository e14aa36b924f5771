#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/search/algorithms.h"

namespace moma::tune {

struct Told {
  double value = 0.0;
  std::vector<double> constraints;  ///< mean - bound; only for algorithms with constraints
};

/// The function to minimise, on the unit cube. Returns nothing when the budget is spent, which stops the run.
using UnitFunction = std::function<std::optional<Told>(std::span<const double> unit)>;

struct NloptRun {
  const AlgorithmInfo* algorithm = nullptr;
  const AlgorithmInfo* inner = nullptr;  ///< local algorithm of MLSL and AUGLAG
  std::vector<double> start;             ///< in the unit cube
  std::size_t constraints = 0;           ///< 0 unless the algorithm supports them
  std::uint64_t seed = 0;                ///< for nlopt::srand
  std::size_t population = 0;            ///< 0: NLopt's default
  double initial_step = 0.2;             ///< of local algorithms
  double tolerance = 0.004;              ///< local algorithms end when all coordinates move by less
};

/// Runs NLopt until it converges or the function stops it; returns the reason of the end. An exception of the function
/// ends the run and leaves this function. nlopt::srand resets NLopt's thread-local random state here, so that a run is
/// a function of its arguments.
std::string run_nlopt(const NloptRun& run, const UnitFunction& function);

}  // namespace moma::tune
