#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

namespace moma {

/// Shares out the indices 0, 1, 2, ... among families by weight, spread evenly: in every prefix of n indices family
/// i holds at least floor(n w_i) and at most ceil(n w_i), w_i its part of the sum; so a prefix in which all n w_i are
/// whole is shared out exactly. Weight zero never gets an index and changes nothing.
/// Source: the quota method, Balinski & Young, Fair Representation, 1982.
class Apportionment {
 public:
  /// Weights are finite and >= 0, at least one above 0.
  explicit Apportionment(std::vector<double> weights);

  /// Position of the family in the weights. Thread-safe; remembers what it has worked out, one byte an index: whole
  /// weights repeat after their sum, others are shared out for indices below kMost. Throws GenerationError beyond.
  int family_of(std::uint64_t index) const;
  static constexpr std::uint64_t kMost = 100'000'000;

 private:
  int next() const;

  std::vector<double> weights_;
  double sum_ = 0.0;
  std::uint64_t period_ = 0;  ///< after which the indices are shared out as from 0 on; 0: no such number is known
  int only_ = -1;             ///< the one family with a weight, or -1
  mutable std::mutex mutex_;
  mutable std::vector<std::uint64_t> counts_;
  mutable std::vector<std::uint8_t> given_;
};

}  // namespace moma
