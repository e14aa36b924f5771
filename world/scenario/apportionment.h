#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

namespace moma {

/// Distributes the indices 0, 1, 2, ... evenly among families by weight. In every prefix of n indices family i has at
/// least floor(n w_i) and at most ceil(n w_i), with w_i its share of the sum, so that a prefix in which all n w_i are
/// whole is exact. A family of weight zero gets no index and changes nothing. Source: the quota method, Balinski &
/// Young, Fair Representation, 1982.
class Apportionment {
 public:
  /// Weights must be finite and >= 0, with at least one above 0.
  explicit Apportionment(std::vector<double> weights);

  /// Returns the family of an index as its position in the weights. Thread-safe. Keeps its results, one byte per index:
  /// whole weights repeat after their sum, others are distributed for indices below kMost. Throws GenerationError
  /// beyond.
  int family_of(std::uint64_t index) const;
  static constexpr std::uint64_t kMost = 100'000'000;

 private:
  int next() const;

  std::vector<double> weights_;
  double sum_ = 0.0;
  std::uint64_t period_ = 0;  ///< period of the pattern; 0: unknown
  mutable std::mutex mutex_;
  mutable std::vector<std::uint64_t> counts_;
  mutable std::vector<std::uint8_t> given_;
};

}  // namespace moma
