#include "eval/stats/intervals.h"

#include <Random123/philox.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace moma::stats {
namespace {

/// Returns the number of standard deviations that hold this share of a normal distribution.
double deviations(double confidence) { return boost::math::quantile(boost::math::normal(), 0.5 + confidence / 2); }

}  // namespace

Interval wilson(std::int64_t successes, std::int64_t n, double confidence) {
  if (n < 0 || successes < 0 || successes > n) throw std::invalid_argument("wilson: need 0 <= successes <= n");
  if (!(confidence > 0.0 && confidence < 1.0)) throw std::invalid_argument("wilson: need a confidence in (0, 1)");
  if (n == 0) return {};
  const double z = deviations(confidence);
  const double zz = z * z;
  const auto k = static_cast<double>(successes);
  const auto m = static_cast<double>(n);
  const double half = std::sqrt(zz * (k * (m - k) / m + zz / 4));
  return {successes == 0 ? 0.0 : (k + zz / 2 - half) / (m + zz), successes == n ? 1.0 : (k + zz / 2 + half) / (m + zz)};
}

Interval difference_of_rates(std::int64_t k, std::int64_t n, std::int64_t l, std::int64_t m, double confidence) {
  const Interval a = wilson(k, n, confidence);
  const Interval b = wilson(l, m, confidence);
  if (n == 0 || m == 0) return {-1.0, 1.0};
  const double p = static_cast<double>(k) / static_cast<double>(n);
  const double q = static_cast<double>(l) / static_cast<double>(m);
  return {p - q - std::hypot(p - a.low, b.high - q), p - q + std::hypot(a.high - p, q - b.low)};
}

Interval difference_of_paired_rates(std::int64_t only_a, std::int64_t only_b, std::int64_t n, double confidence) {
  if (only_a < 0 || only_b < 0 || only_a + only_b > n)
    throw std::invalid_argument("difference_of_paired_rates: need counts of 0 .. n worlds");
  const double z = deviations(confidence);
  const auto m = static_cast<double>(n + 2);
  const double a = static_cast<double>(only_a + 1) / m, b = static_cast<double>(only_b + 1) / m;
  const double half = z * std::sqrt((a + b - (a - b) * (a - b)) / m);
  return {std::max(a - b - half, -1.0), std::min(a - b + half, 1.0)};
}

WeightedMean weighted_mean(const std::vector<double>& values, const std::vector<double>& weights) {
  if (values.size() != weights.size()) throw std::invalid_argument("weighted_mean: sizes differ");
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const double weight = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (!(weight > 0.0)) return {kNone, kNone};
  double mean = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) mean += weights[i] / weight * values[i];
  if (values.size() < 2) return {mean, kNone};
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) squares += std::pow(weights[i] / weight * (values[i] - mean), 2);
  const auto n = static_cast<double>(values.size());
  return {mean, std::sqrt(squares * n / (n - 1.0))};
}

double mcnemar_exact(std::int64_t only_a, std::int64_t only_b) {
  if (only_a < 0 || only_b < 0) throw std::invalid_argument("mcnemar_exact: counts are negative");
  const std::int64_t n = only_a + only_b;
  if (n == 0) return 1.0;
  const boost::math::binomial coin(static_cast<double>(n), 0.5);
  return std::min(1.0, 2.0 * boost::math::cdf(coin, static_cast<double>(std::min(only_a, only_b))));
}

std::int64_t mcnemar_pairs(double discordant, double difference, double power, double level) {
  if (!(difference > 0.0 && difference < 1.0) || !(discordant >= 0.0 && discordant <= 1.0))
    throw std::invalid_argument("mcnemar_pairs: needs a difference in (0, 1) and a discordant share in [0, 1]");
  if (!(power > 0.0 && power < 1.0 && level > 0.0 && level < 1.0))
    throw std::invalid_argument("mcnemar_pairs: needs a power and a level in (0, 1)");
  const boost::math::normal normal;
  const double z_level = boost::math::quantile(normal, 1.0 - level / 2);
  const double z_power = boost::math::quantile(normal, power);
  const double share = std::max(discordant, difference);
  const double root = z_level * std::sqrt(share) + z_power * std::sqrt(share - difference * difference);
  return static_cast<std::int64_t>(std::ceil(root * root / (difference * difference)));
}

std::vector<double> holm(const std::vector<double>& p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
  std::vector<double> adjusted(p_values.size());
  double largest = 0.0;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const double factor = static_cast<double>(order.size() - rank);
    largest = std::max(largest, std::min(1.0, factor * p_values[order[rank]]));
    adjusted[order[rank]] = largest;
  }
  return adjusted;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

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
    const double half = deviations(options.confidence) * std::sqrt(squares / (n - 1.0) / n);
    return {mean, mean - half, mean + half};
  }
  std::vector<double> means(static_cast<std::size_t>(options.replicates));
  for (std::size_t r = 0; r < means.size(); ++r) {
    means[r] = resampled_mean(differences, options.seed, static_cast<std::uint32_t>(r));
  }
  std::ranges::sort(means);
  const double tail = (1.0 - options.confidence) / 2;
  return {mean, quantile(means, tail), quantile(means, 1.0 - tail)};
}

namespace {

constexpr std::size_t kMostExact = 50;

// Ranks are doubled so that shared ranks stay whole numbers.
double exact(const std::vector<int>& doubled_ranks, int doubled_sum) {
  int total = 0;
  for (const int rank : doubled_ranks) total += rank;
  std::vector<double> ways(static_cast<std::size_t>(total) + 1, 0.0);
  ways[0] = 1.0;
  int reached = 0;
  for (const int rank : doubled_ranks) {
    for (int s = reached; s >= 0; --s) ways[static_cast<std::size_t>(s + rank)] += ways[static_cast<std::size_t>(s)];
    reached += rank;
  }
  double above = 0.0;
  for (int s = doubled_sum; s <= total; ++s) above += ways[static_cast<std::size_t>(s)];
  return above * std::ldexp(1.0, -static_cast<int>(doubled_ranks.size()));
}

}  // namespace

double wilcoxon_greater(std::span<const double> differences) {
  std::vector<double> kept;
  for (const double d : differences) {
    if (d != 0.0 && !std::isnan(d)) kept.push_back(d);
  }
  if (kept.empty()) return 1.0;
  std::ranges::sort(kept, [](double a, double b) { return std::abs(a) < std::abs(b); });

  const std::size_t n = kept.size();
  std::vector<int> doubled_ranks(n);
  double tie_term = 0.0;
  int doubled_sum = 0;
  for (std::size_t i = 0; i < n;) {
    std::size_t j = i;
    while (j < n && std::abs(kept[j]) == std::abs(kept[i])) ++j;
    const auto tied = static_cast<double>(j - i);
    tie_term += tied * tied * tied - tied;
    for (std::size_t k = i; k < j; ++k) {
      doubled_ranks[k] = static_cast<int>(i + j + 1);  // twice the mean of ranks i+1 .. j
      if (kept[k] > 0.0) doubled_sum += doubled_ranks[k];
    }
    i = j;
  }
  if (n <= kMostExact) return std::min(1.0, exact(doubled_ranks, doubled_sum));

  const auto count = static_cast<double>(n);
  const double mean = count * (count + 1) / 4;
  const double variance = count * (count + 1) * (2 * count + 1) / 24 - tie_term / 48;
  const double z = (doubled_sum / 2.0 - mean - 0.5) / std::sqrt(variance);
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

}  // namespace moma::stats
