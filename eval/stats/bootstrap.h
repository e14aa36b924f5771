#pragma once

#include <cstdint>
#include <span>

namespace moma::stats {

struct BootstrapOptions {
  int replicates = 9999;
  double confidence = 0.95;
  std::uint64_t seed = 1;  ///< fixed, so that the same table is printed every time
};

inline constexpr std::size_t kResampledPairs = 300;

struct MeanDifference {
  double mean = 0.0;  ///< of a_i - b_i
  double low = 0.0;   ///< 95 % unless told otherwise; NaN where there are too few pairs for one
  double high = 0.0;
};

/// Paired bootstrap of the mean difference a_i - b_i: whole pairs are drawn again with replacement, by Philox with the
/// counter (replicate, draw), so that the result depends on nothing but the arguments. O(replicates * n). Of more than
/// kResampledPairs the interval is the one that the bootstrap approaches: mean -+ z standard errors. Of fewer
/// pairs than a sign test needs to show anything (six for 95 %: 2 / 2^6 < 0.05) there is no interval: their resampled
/// means would leave out zero whenever all differences have one sign. Source: Efron & Tibshirani, An Introduction to
/// the Bootstrap, 1993, ch. 13. Throws std::invalid_argument for sizes that differ or are zero.
MeanDifference paired_bootstrap(std::span<const double> a, std::span<const double> b,
                                const BootstrapOptions& options = {});

}  // namespace moma::stats
