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

  /// Position of the family in the weights. Thread-safe; remembers what it has worked out.
  int family_of(std::uint64_t index) const;

 private:
  int next() const;

  std::vector<double> weights_;
  double sum_ = 0.0;
  int only_ = -1;  ///< the one family with a weight, or -1
  mutable std::mutex mutex_;
  mutable std::vector<std::uint64_t> counts_;
  mutable std::vector<std::uint8_t> given_;
};

}  // namespace moma
