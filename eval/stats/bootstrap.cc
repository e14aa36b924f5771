#include "eval/stats/bootstrap.h"

#include <Random123/philox.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace moma::stats {
namespace {

/// Returns an index in 0 .. n-1 from 32 random bits; the bias of at most n / 2^32 does not matter here.
std::size_t index_below(std::uint32_t bits, std::size_t n) {
  return static_cast<std::size_t>((static_cast<std::uint64_t>(bits) * n) >> 32);
}

double resampled_mean(const std::vector<double>& differences, std::uint64_t seed, std::uint32_t replicate) {
  const r123::Philox4x32::key_type key{{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}};
  r123::Philox4x32 philox;
  double sum = 0.0;
  const std::size_t n = differences.size();
  for (std::size_t i = 0; i < n; i += 4) {
    const r123::Philox4x32::ctr_type counter{{static_cast<std::uint32_t>(i / 4), replicate, 0, 0}};
    const auto bits = philox(counter, key);
    for (std::size_t k = 0; k < std::min<std::size_t>(4, n - i); ++k) sum += differences[index_below(bits[k], n)];
  }
  return sum / static_cast<double>(n);
}

/// Interpolates linearly between order statistics.
double quantile(const std::vector<double>& sorted, double p) {
  const double place = p * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

MeanDifference paired_bootstrap(std::span<const double> a, std::span<const double> b, const BootstrapOptions& options) {
  if (a.size() != b.size() || a.empty()) throw std::invalid_argument("paired_bootstrap: needs pairs, at least one");
  if (options.replicates < 1 || !(options.confidence > 0.0 && options.confidence < 1.0)) {
    throw std::invalid_argument("paired_bootstrap: needs replicates >= 1 and a confidence in (0, 1)");
  }
  std::vector<double> differences(a.size());
  std::transform(a.begin(), a.end(), b.begin(), differences.begin(), std::minus<>());
  const double sum = std::accumulate(differences.begin(), differences.end(), 0.0);
  const double mean = sum / static_cast<double>(differences.size());
  if (2.0 * std::pow(0.5, static_cast<double>(differences.size())) > 1.0 - options.confidence)
    return {mean, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  if (differences.size() > kResampledPairs) {
    double squares = 0.0;
    for (const double difference : differences) squares += (difference - mean) * (difference - mean);
    const auto n = static_cast<double>(differences.size());
    const double half =
        boost::math::quantile(boost::math::normal(), 0.5 + options.confidence / 2) * std::sqrt(squares / (n - 1.0) / n);
    return {mean, mean - half, mean + half};
  }
  std::vector<double> means(static_cast<std::size_t>(options.replicates));
  for (std::size_t r = 0; r < means.size(); ++r) {
    means[r] = resampled_mean(differences, options.seed, static_cast<std::uint32_t>(r));
  }
  std::sort(means.begin(), means.end());
  const double tail = (1.0 - options.confidence) / 2;
  return {mean, quantile(means, tail), quantile(means, 1.0 - tail)};
}

}  // namespace moma::stats
