#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace moma::tune {

/// What the search needs to know about one of NLopt's algorithms. `name` is NLopt's own, with its prefix.
struct AlgorithmInfo {
  std::string_view name;
  bool global = false;
  bool seeded = false;             ///< draws random numbers: nlopt::srand decides its path
  bool takes_constraints = false;  ///< inequality constraints natively; the others get a penalty
  bool needs_local = false;        ///< wraps a local algorithm (MLSL, AUGLAG)
  bool has_population = false;
  int most_variables = 0;  ///< 0: no limit
  std::string_view what;   ///< one line for a person
};

/// Every derivative-free algorithm of NLopt 2.7 that respects bounds (LN_NEWUOA does not; LN_NEWUOA_BOUND does).
std::span<const AlgorithmInfo> algorithms();

/// By NLopt's name with or without its prefix, in any case: GN_CRS2_LM, CRS2_LM, SBPLX, BOBYQA, AGS.
/// Throws std::invalid_argument naming the nearest and all known names.
const AlgorithmInfo& find_algorithm(std::string_view name);

}  // namespace moma::tune
