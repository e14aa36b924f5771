#include "eval/run/warnings.h"

#include <gtest/gtest.h>

namespace moma::run {
namespace {

TrialRow error(const std::string& reason) {
  TrialRow row;
  row.outcome = Outcome::kError;
  row.reason = reason;
  return row;
}

TrialRow success() {
  TrialRow row;
  row.outcome = Outcome::kSuccess;
  return row;
}

TEST(SameError, TwentyOfOneKindAreEnough) {
  SameError errors;
  for (int i = 0; i < SameError::kEnough; ++i) {
    EXPECT_FALSE(errors.enough()) << i;
    errors.look(0, success());
    errors.look(3, error("no wheels"));
  }
  ASSERT_TRUE(errors.enough());
  ASSERT_NE(errors.found(), nullptr);
  EXPECT_EQ(errors.found()->point, 3u);
  EXPECT_EQ(errors.found()->trials, SameError::kEnough);
  EXPECT_EQ(errors.found()->reason, "no wheels");
}

TEST(SameError, OneOtherTrialIsAReasonToGoOn) {
  for (const TrialRow& other : {success(), error("another reason")}) {
    SameError errors;
    for (int i = 0; i < 50; ++i) errors.look(0, i == 10 ? other : error("no wheels"));
    EXPECT_FALSE(errors.enough());
    EXPECT_EQ(errors.found(), nullptr);
  }
}

TEST(SameError, FewTrialsAreToldAtTheEnd) {
  SameError errors;
  errors.look(0, success());
  errors.look(1, error("a"));
  errors.look(2, error("b"));
  errors.look(2, error("b"));
  EXPECT_FALSE(errors.enough());
  ASSERT_NE(errors.found(), nullptr);
  EXPECT_EQ(errors.found()->reason, "b");
  EXPECT_EQ(errors.found()->trials, 2);
}

}  // namespace
}  // namespace moma::run
