#include "eval/search/algorithms.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

#include "controller/config/node.h"
#include "controller/config/suggestion.h"

namespace moma::tune {
namespace {

constexpr bool kYes = true;
constexpr bool kNo = false;

// name, global, seeded, constraints, wraps a local one, population, most variables, what
constexpr std::array kAlgorithms{
    AlgorithmInfo{"GN_CRS2_LM", kYes, kYes, kNo, kNo, kYes, 0, "controlled random search with local mutation"},
    AlgorithmInfo{"GN_DIRECT", kYes, kNo, kNo, kNo, kNo, 0, "dividing rectangles"},
    AlgorithmInfo{"GN_DIRECT_L", kYes, kNo, kNo, kNo, kNo, 0, "dividing rectangles, biased to local search"},
    AlgorithmInfo{"GN_DIRECT_L_RAND", kYes, kYes, kNo, kNo, kNo, 0, "the same with some randomness"},
    AlgorithmInfo{"GN_DIRECT_NOSCAL", kYes, kNo, kNo, kNo, kNo, 0, "DIRECT without scaling"},
    AlgorithmInfo{"GN_DIRECT_L_NOSCAL", kYes, kNo, kNo, kNo, kNo, 0, "DIRECT_L without scaling"},
    AlgorithmInfo{"GN_DIRECT_L_RAND_NOSCAL", kYes, kYes, kNo, kNo, kNo, 0, "DIRECT_L_RAND without scaling"},
    AlgorithmInfo{"GN_ORIG_DIRECT", kYes, kNo, kYes, kNo, kNo, 64, "Gablonsky's DIRECT"},
    AlgorithmInfo{"GN_ORIG_DIRECT_L", kYes, kNo, kYes, kNo, kNo, 64, "Gablonsky's DIRECT_L"},
    AlgorithmInfo{"GN_ISRES", kYes, kYes, kYes, kNo, kYes, 0, "evolution strategy with stochastic ranking"},
    AlgorithmInfo{"GN_ESCH", kYes, kYes, kNo, kNo, kNo, 0, "evolutionary algorithm"},
    AlgorithmInfo{"GN_AGS", kYes, kNo, kYes, kNo, kNo, 10, "space-filling curve search"},
    AlgorithmInfo{"G_MLSL", kYes, kYes, kNo, kYes, kYes, 0, "multi-level single linkage: many local searches"},
    AlgorithmInfo{"G_MLSL_LDS", kYes, kNo, kNo, kYes, kYes, 0, "the same from a low-discrepancy sequence"},
    AlgorithmInfo{"LN_SBPLX", kNo, kNo, kNo, kNo, kNo, 0, "Nelder-Mead on subspaces"},
    AlgorithmInfo{"LN_NELDERMEAD", kNo, kNo, kNo, kNo, kNo, 0, "Nelder-Mead simplex"},
    AlgorithmInfo{"LN_BOBYQA", kNo, kNo, kNo, kNo, kNo, 0, "quadratic models within bounds"},
    AlgorithmInfo{"LN_COBYLA", kNo, kNo, kYes, kNo, kNo, 0, "linear models, with constraints"},
    AlgorithmInfo{"LN_NEWUOA_BOUND", kNo, kNo, kNo, kNo, kNo, 0, "quadratic models, bounds added"},
    AlgorithmInfo{"LN_PRAXIS", kNo, kYes, kNo, kNo, kNo, 0, "principal axes"},
    AlgorithmInfo{"LN_AUGLAG", kNo, kNo, kYes, kYes, kNo, 0, "augmented Lagrangian around a local algorithm"},
};

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

// NLopt's prefixes state global or local, gradient or none; people leave them out.
std::string_view bare(std::string_view name) {
  for (const std::string_view prefix : {"GN_", "LN_", "G_"}) {
    if (name.substr(0, prefix.size()) == prefix) return name.substr(prefix.size());
  }
  return name;
}

}  // namespace

std::span<const AlgorithmInfo> algorithms() { return kAlgorithms; }

const AlgorithmInfo& find_algorithm(std::string_view name) {
  std::string wanted = upper(name);
  if (wanted.substr(0, 6) == "NLOPT_") wanted.erase(0, 6);
  // GN_MLSL is G_MLSL with a local algorithm fixed by NLopt; the search always names the local algorithm.
  if (wanted == "GN_MLSL" || wanted == "GN_MLSL_LDS") wanted.erase(1, 1);
  for (const AlgorithmInfo& info : kAlgorithms) {
    if (info.name == wanted || bare(info.name) == wanted) return info;
  }
  if (wanted == "NEWUOA" || wanted == "LN_NEWUOA") {
    throw std::invalid_argument(fmt::format("algorithm {} ignores bounds; use LN_NEWUOA_BOUND or LN_BOBYQA", name));
  }
  if (wanted.substr(0, 3) == "LD_" || wanted.substr(0, 3) == "GD_") {
    throw std::invalid_argument(
        fmt::format("algorithm {} needs gradients, which no evaluation gives; names that "
                    "start with GN_, G_ or LN_ do without",
                    name));
  }
  std::vector<std::string> known;
  std::string list;
  for (const AlgorithmInfo& info : kAlgorithms) {
    known.emplace_back(bare(info.name));
    list += (list.empty() ? "" : ", ") + std::string(info.name);
  }
  throw std::invalid_argument(
      fmt::format("unknown algorithm '{}'{}; known are {}", name, config::suggestion(bare(wanted), known), list));
}

}  // namespace moma::tune
