#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace moma::tune {

/// Properties of one of NLopt's algorithms. `name` is NLopt's own, with its prefix.
struct AlgorithmInfo {
  std::string_view name;
  bool global = false;
  bool seeded = false;             ///< draws random numbers, seeded by nlopt::srand
  bool takes_constraints = false;  ///< supports inequality constraints; otherwise a penalty replaces them
  bool needs_local = false;        ///< wraps a local algorithm (MLSL, AUGLAG)
  bool has_population = false;
  int most_variables = 0;  ///< 0: no limit
  std::string_view what;   ///< one line of description
};

/// All derivative-free algorithms of NLopt 2.7 that respect bounds (LN_NEWUOA does not; LN_NEWUOA_BOUND does).
std::span<const AlgorithmInfo> algorithms();

/// Finds an algorithm by NLopt's name, with or without prefix, in any case: GN_CRS2_LM, CRS2_LM, SBPLX, BOBYQA, AGS.
/// Throws std::invalid_argument with the nearest and all known names.
const AlgorithmInfo& find_algorithm(std::string_view name);

}  // namespace moma::tune
