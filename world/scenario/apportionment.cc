#include "world/scenario/apportionment.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "world/scenario/worlds.h"

namespace moma {

Apportionment::Apportionment(std::vector<double> weights) : weights_(std::move(weights)), counts_(weights_.size(), 0) {
  // The only family with a weight has every index, whatever the weight.
  if (std::ranges::count_if(weights_, [](double w) { return w > 0.0; }) == 1) *std::ranges::max_element(weights_) = 1.0;
  for (const double weight : weights_) sum_ += weight;
  // If all weights are whole, the pattern repeats after their sum: every family then has its weight of the indices, and
  // all comparisons of next() are exactly those of the beginning.
  const bool whole = std::ranges::all_of(weights_, [](double w) { return w == std::floor(w); });
  if (whole && sum_ <= 1e6) period_ = static_cast<std::uint64_t>(sum_);
}

int Apportionment::family_of(std::uint64_t index) const {
  if (period_ > 0) index %= period_;
  if (index >= kMost)
    throw GenerationError(
        fmt::format("there is no world {}: families whose weights are not whole numbers have {} worlds", index, kMost));
  const std::lock_guard lock(mutex_);
  while (given_.size() <= index) given_.push_back(static_cast<std::uint8_t>(next()));
  return given_[index];
}

int Apportionment::next() const {
  // Among the families below their upper quota, takes the one whose lower quota rises first. Products instead of
  // quotients compare whole weights exactly.
  const auto n = static_cast<double>(given_.size() + 1);
  int best = -1;
  for (int pass = 0; pass < 2 && best < 0; ++pass) {
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      if (weights_[i] <= 0.0) continue;
      // The second pass runs only if rounding of odd weights hides the eligible family.
      if (pass == 0 && !(static_cast<double>(counts_[i]) * sum_ < weights_[i] * n)) continue;
      if (best < 0) {
        best = static_cast<int>(i);
        continue;
      }
      const auto b = static_cast<std::size_t>(best);
      if (static_cast<double>(counts_[i] + 1) * weights_[b] < static_cast<double>(counts_[b] + 1) * weights_[i])
        best = static_cast<int>(i);
    }
  }
  ++counts_[static_cast<std::size_t>(best)];
  return best;
}

}  // namespace moma
