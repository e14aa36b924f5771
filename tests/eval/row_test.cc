// The descriptions of rows and samples: complete, and each member once. What follows from them: the wire
// (cluster_parts_test.cc), the store (store_test.cc, store_columns_test.cc), the trace (cli_test.cc).
#include "eval/trial/row.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tests/support/filled.h"

namespace moma::test {
namespace {

struct Forgetful {
  double told = 0.0;
  std::string forgotten;
};
template <class Visitor>
constexpr void describe(Visitor& v, Of<Forgetful>) {
  v.member("told", &Forgetful::told, Column{});
}

struct Whole {
  int number = 0;
};
template <class Visitor>
constexpr void describe(Visitor& v, Of<Whole>) {
  v.member("number", &Whole::number, Column{});
}

template <class Inner>
struct Nested {
  std::string text;
  VectorX numbers;
  Inner more;
};
template <class Visitor, class Inner>
constexpr void describe(Visitor& v, Of<Nested<Inner>>) {
  v.member("text", &Nested<Inner>::text, Column{});
  v.group("inner", "", [](auto& g) { g.member("numbers", &Nested<Inner>::numbers, Column{}); });
  v.inlined(&Nested<Inner>::more);
}

// What keeps a member from being forgotten: row.cc asserts the same of the real records, and so does the wire.
static_assert(description::count_members<Forgetful>() == 2);
static_assert(!is_complete<Forgetful>());
static_assert(is_complete<Nested<Whole>>());
static_assert(!is_complete<Nested<Forgetful>>());
static_assert(Described<TrialRow> && !Described<VectorX> && !Described<std::string>);

/// Places of the members in a record, and their names.
template <class T>
struct Places {
  T record = {};
  std::size_t n = 0;
  std::set<const void*> places = {};
  std::set<std::string> names = {};
  template <class M>
  void member(std::string_view name, M T::*member, const About& about) {
    EXPECT_FALSE(about.text.empty()) << name << " is not explained";
    add(name, record.*member);
  }
  template <class M>
  void inlined(M T::*member) {
    add("", record.*member);
  }
  template <class M>
  void add(std::string_view name, const M& member) {
    ++n;
    places.insert(&member);
    EXPECT_TRUE(names.insert(std::string(name)).second) << name << " twice";
  }
};

template <class T>
void expect_each_once() {
  Places<T> places;
  describe(places, Of<T>{});
  EXPECT_EQ(places.n, places.places.size()) << "a member is described twice";
  EXPECT_EQ(places.n, description::count_members<T>());
}

TEST(Descriptions, NameEachMemberOnce) {
  expect_each_once<TrialRow>();
  expect_each_once<TrialRow::Timing>();
  expect_each_once<Sample>();
  expect_each_once<EscapeState>();
  expect_each_once<PlanBrief>();
  expect_each_once<PlanVerdict>();
}

TEST(Descriptions, TellRowsApartByEveryMember) {
  TrialRow row;
  Filler(1.0).fill(row);
  const std::string bits = bits_of(row);
  EXPECT_NE(bits_of(TrialRow{}), bits);
  row.timing.deadline_misses += 1;
  EXPECT_NE(bits_of(row), bits);
  EXPECT_EQ(own_bits_of(row).find("deadline_misses"), std::string::npos);
}

}  // namespace
}  // namespace moma::test
