#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <utility>
#include <vector>

#include "eval/stats/comparison.h"
#include "eval/stats/intervals.h"

namespace moma::stats {
namespace {

using nlohmann::json;

/// tests/reports/browser/units_test.mjs asks the page for the same numbers.
const json& reference() {
  static const json kReference = json::parse(std::ifstream(MOMA_SOURCE_DIR "/tests/data/stats_reference.json"));
  return kReference;
}

TEST(Stats, WilsonAsSciPy) {
  ASSERT_GT(reference()["wilson"].size(), 20u);
  for (const json& c : reference()["wilson"]) {
    const Interval interval = wilson(c["k"], c["n"], c["confidence"]);
    EXPECT_NEAR(interval.low, c["low"].get<double>(), 1e-12) << c;
    EXPECT_NEAR(interval.high, c["high"].get<double>(), 1e-12) << c;
  }
}

TEST(Stats, WilsonAtTheEnds) {
  EXPECT_EQ(wilson(0, 25).low, 0.0);
  EXPECT_EQ(wilson(25, 25).high, 1.0);
  EXPECT_EQ(wilson(0, 0).low, 0.0);
  EXPECT_EQ(wilson(0, 0).high, 1.0);
  EXPECT_THROW(wilson(3, 2), std::invalid_argument);
  EXPECT_THROW(wilson(-1, 2), std::invalid_argument);
  EXPECT_THROW(wilson(1, 2, 1.0), std::invalid_argument);
}

TEST(Stats, McNemarAsSciPy) {
  for (const json& c : reference()["mcnemar"]) {
    const double p = mcnemar_exact(c["a"], c["b"]);
    EXPECT_NEAR(p, c["p"].get<double>(), 1e-12 + 1e-10 * p) << c;
    EXPECT_EQ(p, mcnemar_exact(c["b"], c["a"])) << "the order of the sides matters";
  }
  EXPECT_EQ(mcnemar_exact(0, 0), 1.0);
}

// The power of the exact test at that number of pairs, by summing over every split of every number of discordant ones.
TEST(Stats, PairsForADifferenceGiveThePower) {
  for (const auto& [discordant, difference] : {std::pair{0.3, 0.1}, {0.2, 0.1}, {0.5, 0.15}}) {
    const std::int64_t n = mcnemar_pairs(discordant, difference);
    const double p_a = (discordant + difference) / 2;
    const double p_b = (discordant - difference) / 2;
    double power = 0.0;
    const auto lg = [](double x) { return std::lgamma(x + 1.0); };
    for (std::int64_t a = 0; a <= n; ++a) {
      for (std::int64_t b = 0; a + b <= n; ++b) {
        const auto x = static_cast<double>(a);
        const auto y = static_cast<double>(b);
        const double rest = static_cast<double>(n) - x - y;
        const double log_p = lg(static_cast<double>(n)) - lg(x) - lg(y) - lg(rest) + x * std::log(p_a) +
                             y * std::log(p_b) + rest * std::log(1.0 - discordant);
        if (log_p > -25.0 && mcnemar_exact(a, b) <= 0.05) power += std::exp(log_p);
      }
    }
    EXPECT_GT(power, 0.74) << discordant << " " << difference << " " << n;
    EXPECT_LT(power, 0.83) << discordant << " " << difference << " " << n;
  }
  EXPECT_EQ(mcnemar_pairs(0.0, 0.1), mcnemar_pairs(0.1, 0.1));
  EXPECT_GT(mcnemar_pairs(0.3, 0.01), mcnemar_pairs(0.3, 0.02));
  EXPECT_THROW(mcnemar_pairs(0.3, 0.0), std::invalid_argument);
}

// On simulated pairs with a known mean difference the interval holds it as often as it says, within three standard
// errors of the simulation; the percentile interval of so small a sample is known to be a little short.
TEST(Stats, PairedBootstrapCoverage) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  constexpr int kTimes = 1000;
  int held = 0;
  for (int k = 0; k < kTimes; ++k) {
    std::vector<double> a;
    std::vector<double> b;
    for (int i = 0; i < 60; ++i) {
      const double world = normal(random);
      a.push_back(world + 0.3 + normal(random));
      b.push_back(world);
    }
    const MeanDifference d = paired_bootstrap(a, b, {.replicates = 499, .seed = static_cast<std::uint64_t>(k)});
    held += d.low <= 0.3 && 0.3 <= d.high ? 1 : 0;
  }
  const double coverage = static_cast<double>(held) / kTimes;
  EXPECT_NEAR(coverage, 0.945, 3.0 * std::sqrt(0.95 * 0.05 / kTimes));
}

TEST(Stats, HolmAsStatsmodels) {
  for (const json& c : reference()["holm"]) {
    const std::vector<double> adjusted = holm(c["p"].get<std::vector<double>>());
    ASSERT_EQ(adjusted.size(), c["adjusted"].size());
    for (std::size_t i = 0; i < adjusted.size(); ++i) EXPECT_NEAR(adjusted[i], c["adjusted"][i].get<double>(), 1e-14);
  }
  EXPECT_TRUE(holm({}).empty());
}

TEST(Stats, Median) {
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_TRUE(std::isnan(median({})));
}

// The draws differ from SciPy's; the ends of its interval from 200000 replicates have a sampling error far below the
// spread between replicates of ours.
TEST(Stats, PairedBootstrapNearSciPy) {
  for (const json& c : reference()["bootstrap"]) {
    const auto a = c["a"].get<std::vector<double>>();
    const auto b = c["b"].get<std::vector<double>>();
    const MeanDifference d = paired_bootstrap(a, b, {.replicates = 20000});
    const double width = c["high"].get<double>() - c["low"].get<double>();
    EXPECT_NEAR(d.mean, c["mean"].get<double>(), 1e-12);
    EXPECT_NEAR(d.low, c["low"].get<double>(), 0.02 * width);
    EXPECT_NEAR(d.high, c["high"].get<double>(), 0.02 * width);
  }
}

TEST(Stats, PairedBootstrapIsAFunctionOfItsArguments) {
  const std::vector<double> a{1.0, 2.0, 5.0, 3.0, 8.0, 2.0};
  const std::vector<double> b{0.5, 2.5, 4.0, 3.5, 6.0, 1.0};
  const MeanDifference first = paired_bootstrap(a, b);
  const MeanDifference again = paired_bootstrap(a, b);
  EXPECT_EQ(first.low, again.low);
  EXPECT_EQ(first.high, again.high);
  const MeanDifference few = paired_bootstrap(a, b, {.replicates = 50});
  const MeanDifference other = paired_bootstrap(a, b, {.replicates = 50, .seed = 2});
  EXPECT_TRUE(other.low != few.low || other.high != few.high);
  EXPECT_THROW(paired_bootstrap(a, std::vector<double>{1.0}), std::invalid_argument);
  EXPECT_THROW(paired_bootstrap({}, {}), std::invalid_argument);
}

TEST(Stats, PairedBootstrapOfEqualSamplesIsExactlyZero) {
  const std::vector<double> a{1.0, 2.0, 5.0, 3.0, 8.0, 2.0};
  const MeanDifference d = paired_bootstrap(a, a);
  EXPECT_EQ(d.mean, 0.0);
  EXPECT_EQ(d.low, 0.0);
  EXPECT_EQ(d.high, 0.0);
}

// Newcombe 1998, table II, method 10.
TEST(Stats, DifferenceOfRatesAsNewcombePublishedIt) {
  const auto expect = [](std::int64_t k, std::int64_t n, std::int64_t l, std::int64_t m, double low, double high) {
    const Interval interval = difference_of_rates(k, n, l, m);
    EXPECT_NEAR(interval.low, low, 5.1e-5) << k << "/" << n << " - " << l << "/" << m;
    EXPECT_NEAR(interval.high, high, 5.1e-5) << k << "/" << n << " - " << l << "/" << m;
  };
  expect(56, 70, 48, 80, 0.0524, 0.3339);
  expect(9, 10, 3, 10, 0.1705, 0.8090);
  expect(10, 10, 0, 10, 0.6075, 1.0);
  EXPECT_EQ(difference_of_rates(0, 0, 3, 10).low, -1.0);
}

TEST(Stats, DifferenceOfPairedRatesAsPublished) {
  // Fagerland, Lydersen & Laake 2014 (Statistics in Medicine 33, 2850), airway hyper-responsiveness.
  const Interval published = difference_of_paired_rates(1, 7, 21);
  EXPECT_NEAR(published.low, -0.508, 5.1e-4);
  EXPECT_NEAR(published.high, -0.013, 5.1e-4);
  // Nothing seen to differ is no proof that nothing does.
  EXPECT_NEAR(difference_of_paired_rates(0, 0, 10).high, 0.231, 5.1e-4);
  EXPECT_EQ(difference_of_paired_rates(0, 0, 0).low, -1.0);
  EXPECT_EQ(difference_of_paired_rates(30, 0, 30).high, 1.0);
  EXPECT_THROW((void)difference_of_paired_rates(2, -1, 9), std::invalid_argument);
  EXPECT_THROW((void)difference_of_paired_rates(5, 5, 9), std::invalid_argument);
}

TEST(Stats, DifferenceOfPairedRatesAsThePaperHasIt) {
  for (const json& c : reference()["paired_rates"]) {
    const Interval interval = difference_of_paired_rates(c["only_b"], c["only_a"], c["n"]);
    EXPECT_NEAR(interval.low, c["low"].get<double>(), 1e-12) << c;
    EXPECT_NEAR(interval.high, c["high"].get<double>(), 1e-12) << c;
  }
}

// Over all outcomes of n worlds with their probabilities: the interval holds the true difference as often as it says.
TEST(Stats, DifferenceOfPairedRatesHoldsTheTruth) {
  const auto lg = [](std::int64_t k) { return std::lgamma(static_cast<double>(k) + 1.0); };
  const auto power = [](std::int64_t k, double p) { return static_cast<double>(k) * std::log(p); };
  for (const std::int64_t n : {20, 40, 100}) {
    for (const auto& [only_a, only_b] :
         {std::pair{0.1, 0.05}, {0.2, 0.1}, {0.05, 0.02}, {0.3, 0.1}, {0.1, 0.1}, {0.02, 0.02}, {0.4, 0.01}}) {
      double held = 0.0;
      for (std::int64_t a = 0; a <= n; ++a) {
        for (std::int64_t b = 0; a + b <= n; ++b) {
          const Interval interval = difference_of_paired_rates(a, b, n);
          if (interval.low > only_a - only_b || only_a - only_b > interval.high) continue;
          held += std::exp(lg(n) - lg(a) - lg(b) - lg(n - a - b) + power(a, only_a) + power(b, only_b) +
                           power(n - a - b, 1.0 - only_a - only_b));
        }
      }
      EXPECT_GT(held, 0.93) << n << " " << only_a << " " << only_b;
    }
  }
}

// One sign in five pairs is no difference shown: a coin does that in 6 % of all cases.
TEST(Stats, FewPairsHaveNoInterval) {
  const std::vector<double> a{1.0, 2.0, 5.0, 3.0, 8.0, 4.0};
  const std::vector<double> b{0.5, 1.5, 4.0, 2.5, 6.0, 3.0};
  for (std::size_t n = 1; n <= a.size(); ++n) {
    const MeanDifference d = paired_bootstrap({a.data(), n}, {b.data(), n});
    EXPECT_GT(d.mean, 0.0);
    EXPECT_EQ(std::isnan(d.low), n < 6) << n;
    EXPECT_EQ(std::isnan(d.high), n < 6) << n;
  }
  EXPECT_FALSE(std::isnan(paired_bootstrap({a.data(), 3}, {b.data(), 3}, {.confidence = 0.7}).low));
}

// tests/reports/browser/units_test.mjs asks the page for the same numbers.
TEST(StatsComparison, TheIntervalIsThePagesToo) {
  const std::vector<double> a{1.0, 2.0, 5.0, 3.0, 8.0, 2.0};
  const std::vector<double> b{0.5, 2.5, 4.0, 3.5, 6.0, 1.0};
  const MeanDifference d = paired_bootstrap(a, b);
  EXPECT_DOUBLE_EQ(d.low, -1.0 / 12);
  EXPECT_DOUBLE_EQ(d.high, 1.25);
}

// Beyond kResampledPairs the interval is the limit of the bootstrap's: the two are near each other at the border.
TEST(StatsComparison, ManyPairsHaveTheLimitOfTheBootstrap) {
  std::mt19937_64 random(7);
  std::exponential_distribution<double> skewed;
  std::vector<double> a, zero;
  for (std::size_t i = 0; i < kResampledPairs + 1; ++i) {
    a.push_back(skewed(random));
    zero.push_back(0.0);
  }
  const MeanDifference many = paired_bootstrap(a, zero);
  const MeanDifference one_less = paired_bootstrap({a.data(), kResampledPairs}, {zero.data(), kResampledPairs});
  const double width = many.high - many.low;
  EXPECT_GT(width, 0.0);
  EXPECT_NEAR(many.low, one_less.low, 0.05 * width);
  EXPECT_NEAR(many.high, one_less.high, 0.05 * width);
}

// A behaves alike but reports an error before most of its time-outs: that gains nothing.
TEST(StatsComparison, AnErrorIsNoSuccess) {
  std::vector<std::pair<Ending, Ending>> endings;
  for (int world = 0; world < 60; ++world) {
    const bool reached = world < 31;
    const bool leaves = !reached && world < 57;
    endings.push_back({{reached, false, leaves}, {reached, false, false}});
  }
  const Comparison c = compare(endings, {});
  EXPECT_EQ(c.n, 60);
  EXPECT_EQ(c.errors_a, 26);
  EXPECT_EQ(c.errors_b, 0);
  EXPECT_EQ(c.worlds_with_errors, 26);
  EXPECT_DOUBLE_EQ(c.rate("success").a.rate, 31.0 / 60);
  EXPECT_EQ(c.rate("success").difference, 0.0);
  EXPECT_EQ(c.rate("success").shown(), 0);
  ASSERT_TRUE(c.sans_errors.has_value());
  EXPECT_EQ(c.sans_errors->n, 34);
  EXPECT_DOUBLE_EQ(c.sans_errors->a.rate, 31.0 / 34);
  EXPECT_TRUE(std::isnan(c.sans_errors->p_holm)) << "no part of the correction";
}

TEST(StatsComparison, RatesAndMeansAreOfTheSameWorlds) {
  std::vector<std::pair<Ending, Ending>> endings;
  PairedValues time{"time", {}, {}};
  for (int world = 0; world < 20; ++world) {
    const bool a = world < 8, b = world < 18;
    endings.push_back({{a, !a, false}, {b, false, false}});
    time.a.push_back(a ? 5.0 + world : kUnknown);
    time.b.push_back(b ? 4.0 + world : kUnknown);
  }
  const Comparison c = compare(endings, {{time}});
  EXPECT_FALSE(c.sans_errors.has_value());
  const PairedRate& success = c.rate("success");
  EXPECT_EQ(success.only_a, 0);
  EXPECT_EQ(success.only_b, 10);
  EXPECT_EQ(success.difference, 0.5);
  EXPECT_EQ(success.interval.low, difference_of_paired_rates(10, 0, 20).low);
  EXPECT_EQ(success.p, mcnemar_exact(10, 0));
  EXPECT_EQ(success.p_holm, holm({mcnemar_exact(10, 0), mcnemar_exact(12, 0)})[0]);
  EXPECT_EQ(success.shown(), 1);
  EXPECT_EQ(c.rate("collision").shown(), -1);
  EXPECT_EQ(c.mean("time").n, 8);
  EXPECT_DOUBLE_EQ(c.mean("time").difference, -1.0);
  EXPECT_EQ(c.mean("time").shown(), -1);
  EXPECT_THROW((void)c.mean("path"), std::out_of_range);
  const Comparison none = compare({}, {});
  EXPECT_TRUE(std::isnan(none.rate("success").difference));
}

TEST(Stats, WeightedMeansAndTheirErrors) {
  const std::vector<double> values = {1, 2, 4, 7};
  const WeightedMean equal = weighted_mean(values, {2, 2, 2, 2});
  EXPECT_DOUBLE_EQ(equal.mean, 3.5);
  EXPECT_NEAR(equal.error, std::sqrt((6.25 + 2.25 + 0.25 + 12.25) / 3) / 2, 1e-15) << "standard deviation / sqrt(n)";
  EXPECT_DOUBLE_EQ(weighted_mean(values, {1, 1, 1, 5}).mean, 42.0 / 8);
  EXPECT_EQ(weighted_mean(values, {0, 0, 3, 0}).mean, 4.0);
  EXPECT_TRUE(std::isnan(weighted_mean({}, {}).mean));
  EXPECT_TRUE(std::isnan(weighted_mean({3}, {1}).error));
  EXPECT_THROW(weighted_mean({1}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace moma::stats
