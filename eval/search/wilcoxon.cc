#include "eval/search/wilcoxon.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace moma::tune {
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
  std::sort(kept.begin(), kept.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });

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

}  // namespace moma::tune
