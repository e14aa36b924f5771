#pragma once

#include <span>
#include <string_view>

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

/// By NLopt's name with or without its prefix, in any case: GN_CRS2_LM, crs2_lm. Throws std::invalid_argument naming
/// the nearest and all.
const AlgorithmInfo& find_algorithm(std::string_view name);

}  // namespace moma::tune
