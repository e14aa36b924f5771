#pragma once

#include <span>

namespace moma::tune {

/// Returns the one-sided p-value of Wilcoxon's signed-rank test: the probability of at least this sum of positive ranks
/// if the differences were symmetric about zero. Zeros are left out; ties share their mean rank. Exact (the
/// distribution over all sign patterns, ties included) up to 50 differences; the normal approximation with tie and
/// continuity corrections beyond. 1 without a difference. Source: Wilcoxon, Biometrics Bulletin 1(6), 1945; Hollander,
/// Wolfe & Chicken, Nonparametric Statistical Methods, 3rd ed., section 3.1.
double wilcoxon_greater(std::span<const double> differences);

}  // namespace moma::tune
