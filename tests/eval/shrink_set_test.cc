#include "eval/risk/shrink_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>

namespace moma::risk {
namespace {

/// Counts what is asked; every set that is asked for has to hold `needed`, and to be new if it passes.
struct Asked {
  std::function<bool(const Things&)> fails;
  std::optional<std::size_t> needed;
  int sets = 0;
  std::set<Things> passed = {};

  FirstFailing first() {
    return [this](const std::vector<Things>& choices) -> std::optional<std::size_t> {
      sets += static_cast<int>(choices.size());
      for (std::size_t i = 0; i < choices.size(); ++i) {
        EXPECT_TRUE(std::is_sorted(choices[i].begin(), choices[i].end()));
        EXPECT_TRUE(!needed || std::binary_search(choices[i].begin(), choices[i].end(), *needed));
        if (fails(choices[i])) return i;
        EXPECT_TRUE(passed.insert(choices[i]).second);
      }
      return std::nullopt;
    };
  }
};

bool holds(const Things& set, const Things& part) {
  return std::includes(set.begin(), set.end(), part.begin(), part.end());
}

Things shrink(Asked& asked, std::size_t count) { return shrink_set(count, asked.needed, asked.first()); }

TEST(ShrinkSet, OneAlonePairsAndMore) {
  for (const Things& cause : {Things{}, Things{3}, Things{3, 7}, Things{0, 3, 13}, Things{1, 3, 4, 9, 12}}) {
    Asked any{[&](const Things& set) { return holds(set, cause); }, std::nullopt};
    EXPECT_EQ(shrink(any, 14), cause);
    EXPECT_LT(any.sets, 200);
    if (cause.empty()) continue;
    Asked touched{any.fails, 3};
    EXPECT_EQ(shrink(touched, 14), cause);
  }
}

TEST(ShrinkSet, APairThatFailsWhereTheHalvesDoNot) {
  // All together, or 2 with 9 alone: nothing in between.
  Asked asked{[](const Things& set) { return set.size() == 14 || set == Things{2, 9}; }, 2};
  EXPECT_EQ(shrink(asked, 14), (Things{2, 9}));
  // A triple that only pairs of what is left find.
  Asked triple{[](const Things& set) { return holds(set, {2, 4, 5, 9, 11}) || set == Things{2, 5, 11}; }, 2};
  EXPECT_EQ(shrink(triple, 14), (Things{2, 5, 11}));
}

TEST(ShrinkSet, LeavesNothingThatCanGo) {
  // Any four of the first eight, an even number of the others.
  Asked asked{[](const Things& set) {
                const auto first = std::count_if(set.begin(), set.end(), [](std::size_t i) { return i < 8; });
                return first >= 4 && (static_cast<std::ptrdiff_t>(set.size()) - first) % 2 == 0;
              },
              std::nullopt};
  const Things left = shrink(asked, 16);
  ASSERT_TRUE(asked.fails(left));
  for (const std::size_t one : left) {
    Things less = left;
    less.erase(std::find(less.begin(), less.end(), one));
    EXPECT_FALSE(asked.fails(less)) << one;
  }
}

TEST(ShrinkSet, SinglyTakesAwayOneItemAtATime) {
  // 2 with 9 alone fails as well, but between it and the even ones everything passes.
  Asked asked{[](const Things& set) { return set == Things{2, 9} || holds(set, {0, 2, 4, 6}); }, 2};
  EXPECT_EQ(shrink_set(14, asked.needed, asked.first(), true), (Things{0, 2, 4, 6}));
}

TEST(ShrinkSet, ThatCannotShrinkStays) {
  Asked asked{[](const Things& set) { return set.size() == 5; }, std::nullopt};
  EXPECT_EQ(shrink(asked, 5), (Things{0, 1, 2, 3, 4}));
  Asked none{[](const Things&) { return true; }, std::nullopt};
  EXPECT_EQ(shrink(none, 0), Things{});
}

}  // namespace
}  // namespace moma::risk
