#include <boost/random/sobol.hpp>
#include <numeric>
#include <utility>

#include "eval/suite/sweep.h"
#include "world/draws.h"

namespace moma {

std::vector<std::vector<double>> latin_hypercube(std::uint64_t seed, std::size_t n, std::size_t dimensions) {
  std::vector<std::vector<double>> points(n, std::vector<double>(dimensions));
  std::vector<std::size_t> order(n);
  for (std::size_t axis = 0; axis < dimensions; ++axis) {
    Draws draws(seed, axis, Stream::kDesign);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = n; i > 1; --i) std::swap(order[i - 1], order[draws.choice(i)]);  // Fisher-Yates
    for (std::size_t i = 0; i < n; ++i)
      points[i][axis] = (static_cast<double>(order[i]) + draws.uniform()) / static_cast<double>(n);
  }
  return points;
}

std::vector<std::vector<double>> sobol(std::size_t n, std::size_t dimensions) {
  boost::random::sobol engine(dimensions);
  std::vector<std::vector<double>> points(n, std::vector<double>(dimensions));
  for (auto& point : points)
    for (double& u : point) u = static_cast<double>(engine() >> 11) * 0x1p-53;
  return points;
}

}  // namespace moma
