#include "eval/stats/intervals.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
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
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
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
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

}  // namespace moma::stats
