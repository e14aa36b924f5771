#include "eval/search/algorithms.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>
#include <string>
#include <vector>

#include "controller/config/node.h"

namespace moma::tune {
namespace {

constexpr std::array kAlgorithms{
    AlgorithmInfo{"GN_CRS2_LM", true, true},    // controlled random search with local mutation
    AlgorithmInfo{"GN_DIRECT_L", true, false},  // dividing rectangles, biased to local search
    AlgorithmInfo{"LN_BOBYQA", false, false},   // quadratic models
    AlgorithmInfo{"LN_SBPLX", false, false},    // Nelder-Mead on subspaces
};

}  // namespace

std::span<const AlgorithmInfo> algorithms() { return kAlgorithms; }

const AlgorithmInfo& find_algorithm(std::string_view name) {
  std::string wanted(name);
  for (char& c : wanted) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  std::vector<std::string> known;
  for (const AlgorithmInfo& info : kAlgorithms) {
    if (info.name == wanted || info.name.substr(3) == wanted) return info;
    known.emplace_back(info.name.substr(3));
  }
  throw std::invalid_argument(fmt::format("unknown algorithm '{}'{}; known are {}", name,
                                          config::suggestion(wanted, known), fmt::join(known, ", ")));
}

}  // namespace moma::tune
