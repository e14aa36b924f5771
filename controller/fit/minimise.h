#pragma once

#include <functional>
#include <vector>

namespace moma::fit {

/// Variables of minimise(): start, first step and bounds of each.
struct Variables {
  std::vector<double> start;
  std::vector<double> step;
  std::vector<double> lower;
  std::vector<double> upper;
};

/// Returns a local minimum of f near `start`, for functions with kinks: Subplex (Rowan 1990, NLopt's LN_SBPLX), which
/// needs no derivatives and draws no random numbers. Never worse than the start. f must not throw.
std::vector<double> minimise(const std::function<double(const std::vector<double>&)>& f, const Variables& variables,
                             int evaluations);

}  // namespace moma::fit
