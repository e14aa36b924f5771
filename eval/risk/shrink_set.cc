#include "eval/risk/shrink_set.h"

#include <algorithm>
#include <set>

namespace moma::risk {
namespace {

constexpr std::size_t kMostForPairs = 12;

Things with(Things base, const Things& more) {
  base.insert(base.end(), more.begin(), more.end());
  std::ranges::sort(base);
  return base;
}

/// Returns `count` parts of nearly equal size and, if `rest`, the complement of each.
std::vector<Things> parts(const Things& all, std::size_t count, bool rest) {
  std::vector<Things> out;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t begin = all.size() * k / count, end = all.size() * (k + 1) / count;
    Things part;
    for (std::size_t i = 0; i < all.size(); ++i)
      if ((begin <= i && i < end) != rest) part.push_back(all[i]);
    out.push_back(std::move(part));
  }
  return out;
}

std::vector<Things> pairs(const Things& all) {
  std::vector<Things> out;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j) out.push_back({all[i], all[j]});
  return out;
}

}  // namespace

Things shrink_set(std::size_t count, std::optional<std::size_t> needed, const FirstFailing& failing, bool singly) {
  Things base, others;
  std::set<Things> passed;
  if (needed) base.push_back(*needed);
  for (std::size_t i = 0; i < count; ++i)
    if (i != needed) others.push_back(i);
  // Takes the first failing set of some choices among the others.
  const auto take = [&](std::vector<Things> choices) {
    std::erase_if(choices, [&](const Things& choice) { return passed.contains(choice); });
    if (choices.empty()) return false;
    std::vector<Things> sets;
    for (const Things& choice : choices) sets.push_back(with(base, choice));
    const std::optional<std::size_t> found = failing(sets);
    if (found) others = choices[*found];
    if (!found) passed.insert(choices.begin(), choices.end());
    return found.has_value();
  };
  std::vector<Things> few = parts(others, others.size(), false);
  few.insert(few.begin(), Things{});
  if (others.empty() || (!singly && take(few))) return with(base, others);
  for (std::size_t n = 2; !singly && others.size() >= 2;) {
    if (take(parts(others, n, false))) {
      n = 2;
    } else if (n > 2 && take(parts(others, n, true))) {
      n = std::max<std::size_t>(n - 1, 2);
    } else if (n >= others.size()) {
      break;
    } else {
      n = std::min(2 * n, others.size());
    }
  }
  if (!singly && others.size() > 2 && others.size() <= kMostForPairs) take(pairs(others));
  while (!others.empty() && take(parts(others, others.size(), true))) {
  }
  return with(base, others);
}

}  // namespace moma::risk
