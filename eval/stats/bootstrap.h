#pragma once

#include <cstdint>
#include <span>

namespace moma::stats {

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

}  // namespace moma::stats
