#include <Random123/philox.h>

#include <boost/random/sobol.hpp>
#include <numeric>

#include "eval/suite/sweep.h"

namespace moma {
namespace {

// Counter-based: draw i of axis `a` is a pure function of (seed, axis, i).
std::uint64_t bits(std::uint64_t seed, std::uint64_t axis, std::uint64_t i) {
  using Philox = r123::Philox4x64;
  const Philox::ctr_type counter{{i, axis, 0x73776565u /* "swee": apart from the worlds' streams */, 0}};
  const Philox::key_type key{{seed, 0}};
  return Philox{}(counter, key)[0];
}

double unit(std::uint64_t random) { return static_cast<double>(random >> 11) * 0x1p-53; }

}  // namespace

std::vector<std::vector<double>> latin_hypercube(std::uint64_t seed, std::size_t n, std::size_t dimensions) {
  std::vector<std::vector<double>> points(n, std::vector<double>(dimensions));
  std::vector<std::size_t> order(n);
  for (std::size_t a = 0; a < dimensions; ++a) {
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = n; i > 1; --i) {   // Fisher-Yates
      const auto j = static_cast<std::size_t>(unit(bits(seed, a, 2 * i)) * static_cast<double>(i));
      std::swap(order[i - 1], order[j]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const double inside = unit(bits(seed, a, 2 * i + 1));
      points[i][a] = (static_cast<double>(order[i]) + inside) / static_cast<double>(n);
    }
  }
  return points;
}

std::vector<std::vector<double>> sobol(std::size_t n, std::size_t dimensions) {
  boost::random::sobol engine(dimensions);
  std::vector<std::vector<double>> points(n, std::vector<double>(dimensions));
  for (auto& point : points)
    for (double& u : point) u = unit(engine());
  return points;
}

}  // namespace moma
