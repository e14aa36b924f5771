#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace moma::tune {

/// One of NLopt's algorithms, by NLopt's name.
struct AlgorithmInfo {
  std::string_view name;
  bool global = false;
  bool has_population = false;
};

/// Two global ones and two local ones, derivative-free and within bounds. None takes constraints: a candidate that
/// breaks one gets a penalty.
std::span<const AlgorithmInfo> algorithms();

/// Finds an algorithm by NLopt's name, with or without its prefix, in any case: GN_CRS2_LM, crs2_lm. Throws
/// std::invalid_argument that names the nearest and all.
const AlgorithmInfo& find_algorithm(std::string_view name);

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

/// The scores that one NLopt run gets. A cut candidate gets its estimate (Evaluation::merit), but never a better score
/// than a fully measured one of this run: at least the worst full score before it, and a later full score is reported
/// as no worse than any cut one before it. In either order no cut candidate looks better than a fully measured one.
/// Only the ranking among candidates worse than a cut one is lost.
class NloptScores {
 public:
  double operator()(double value, bool cut) {
    if (cut) {
      value = std::max(value, worst_full_);
      least_cut_ = std::min(least_cut_, value);
    } else {
      value = std::min(value, least_cut_);
      worst_full_ = std::max(worst_full_, value);
    }
    return value;
  }

 private:
  double worst_full_ = -std::numeric_limits<double>::infinity();
  double least_cut_ = std::numeric_limits<double>::infinity();
};

}  // namespace moma::tune
