#include "eval/cli/doubts.h"

#include <gtest/gtest.h>

namespace moma::cli {
namespace {

TEST(Doubts, AreSilentWhereThereAreNone) {
  Doubts doubts;
  TrialRow row;
  row.detector_checks = 50;
  for (const Outcome outcome : {Outcome::kSuccess, Outcome::kCollision, Outcome::kTimeout, Outcome::kTipped}) {
    row.outcome = outcome;
    doubts.look(row);
  }
  EXPECT_TRUE(doubts.warnings().empty());
}

TEST(Doubts, SayEachKindWithItsTrials) {
  Doubts doubts;
  TrialRow row;
  row.outcome = Outcome::kCollision;
  row.detector_disagreements = 2;
  row.detector_deepest_m = 3e-5;
  doubts.look(row);
  row.detector_deepest_m = 2e-5;
  row.lcp_messages = 4;
  doubts.look(row);
  row = {};
  row.outcome = Outcome::kError;
  doubts.look(row);
  const std::vector<std::string> warnings = doubts.warnings();
  ASSERT_EQ(warnings.size(), 3u);
  EXPECT_NE(warnings[0].find("2 trials where the two detectors of contact disagree, by 3e-05 m"), std::string::npos)
      << warnings[0];
  EXPECT_NE(warnings[1].find("1 trial with messages"), std::string::npos) << warnings[1];
  EXPECT_NE(warnings[2].find("outcome = 'error'"), std::string::npos) << warnings[2];
}

}  // namespace
}  // namespace moma::cli
