#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace moma::stats {

struct Interval {
  double low = 0.0;
  double high = 1.0;
};

/// Returns Wilson's score interval of a rate: its end is exactly 0 (1) if no (every) trial is a success; [0, 1] for n =
/// 0. Source: Wilson, JASA 22, 1927; view v_summary has the same formula in SQL. @param successes 0 <= successes <= n,
/// else std::invalid_argument. @param confidence in (0, 1).
Interval wilson(std::int64_t successes, std::int64_t n, double confidence = 0.95);

/// Returns the interval of the difference p - q of two independent rates, k of n and l of m: Newcombe's hybrid of their
/// Wilson intervals, within [-1, 1]. Source: Newcombe, Statistics in Medicine 17, 1998, method 10.
Interval difference_of_rates(std::int64_t k, std::int64_t n, std::int64_t l, std::int64_t m, double confidence = 0.95);

/// Returns the interval of the difference of the rates of a and b in the same n worlds, with `only_a` and `only_b` hits
/// of one side alone: the adjusted Wald interval, within [-1, 1]. Its width is positive even if no world distinguishes
/// the sides: 0 of 10 may differ from 0 of 10 by 0.23. Source: Bonett & Price, J. Educ. Behav. Stat. 37, 2012; the
/// report page has the same. Throws std::invalid_argument for counts that are negative or more than n.
Interval difference_of_paired_rates(std::int64_t only_a, std::int64_t only_b, std::int64_t n, double confidence = 0.95);

/// A weighted mean, and its standard error by the linearised ratio (Cochran, Sampling Techniques, 1977, 6.4): for equal
/// weights the standard deviation / sqrt(n). NaN for too few values, or without weight.
struct WeightedMean {
  double mean = 0.0;
  double error = 0.0;
};
/// Throws std::invalid_argument for sizes that differ.
WeightedMean weighted_mean(const std::vector<double>& values, const std::vector<double>& weights);

/// Returns the p-value of the two-sided exact McNemar test of `only_a` against `only_b` worlds won by one side alone,
/// under equal chances; 1 without such worlds. Twice the smaller binomial tail, at most 1. Source: McNemar,
/// Psychometrika 12, 1947; the exact form is the sign test.
double mcnemar_exact(std::int64_t only_a, std::int64_t only_b);

/// Returns the number of pairs with which McNemar's test detects a difference of two rates with probability `power` at
/// the two-sided level `level`, if a share `discordant` of the pairs differs. `difference` in (0, 1); a smaller
/// discordant share is raised to it, since a difference needs as many discordant pairs. Throws std::invalid_argument.
/// Source: Connor, Biometrics 43, 1987, eq. 3. The exact test needs about 2 / difference pairs more.
std::int64_t mcnemar_pairs(double discordant, double difference, double power = 0.8, double level = 0.05);

/// Returns Holm's step-down adjusted p-values in the order of the input. Source: Holm, Scand. J. Stat. 6, 1979.
std::vector<double> holm(const std::vector<double>& p_values);

/// Returns the median (mean of the middle two for even sizes); NaN for none. Takes a copy to sort.
double median(std::vector<double> values);

struct BootstrapOptions {
  int replicates = 9999;
  double confidence = 0.95;
  std::uint64_t seed = 1;  ///< fixed, so that every run prints the same table
};

inline constexpr std::size_t kResampledPairs = 300;

struct MeanDifference {
  double mean = 0.0;  ///< mean of a_i - b_i
  double low = 0.0;   ///< 95 % by default; NaN for too few pairs
  double high = 0.0;
};

/// Paired bootstrap of the mean difference a_i - b_i. It resamples whole pairs with replacement, by Philox with the
/// counter (replicate, draw), so that the result depends on the arguments alone. O(replicates * n). For more than
/// kResampledPairs pairs the interval is the bootstrap's limit, mean -+ z standard errors. For fewer pairs than a sign
/// test needs (six for 95 %: 2 / 2^6 < 0.05) there is no interval: resampled means would exclude zero whenever all
/// differences have one sign. Source: Efron & Tibshirani, An Introduction to the Bootstrap, 1993, ch. 13. Throws
/// std::invalid_argument for sizes that differ or are zero.
MeanDifference paired_bootstrap(std::span<const double> a, std::span<const double> b,
                                const BootstrapOptions& options = {});

/// Returns the one-sided p-value of Wilcoxon's signed-rank test: the probability of at least this sum of positive ranks
/// if the differences were symmetric about zero. Zeros are left out; ties share their mean rank. Exact (the
/// distribution over all sign patterns, ties included) up to 50 differences; the normal approximation with tie and
/// continuity corrections beyond. 1 without a difference. Source: Wilcoxon, Biometrics Bulletin 1(6), 1945; Hollander,
/// Wolfe & Chicken, Nonparametric Statistical Methods, 3rd ed., section 3.1.
double wilcoxon_greater(std::span<const double> differences);

}  // namespace moma::stats
