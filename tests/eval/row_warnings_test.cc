#include "eval/run/warnings.h"

#include <gtest/gtest.h>

namespace moma::run {
namespace {

TEST(RowWarnings, AreSilentWhereThereAreNone) {
  RowWarnings found;
  TrialRow row;
  row.detector_checks = 50;
  for (const Outcome outcome : {Outcome::kSuccess, Outcome::kCollision, Outcome::kTimeout, Outcome::kTipped}) {
    row.outcome = outcome;
    found.look(row);
  }
  EXPECT_TRUE(found.sentences().empty());
}

TEST(RowWarnings, SayEachKindWithItsTrials) {
  RowWarnings found;
  TrialRow row;
  row.outcome = Outcome::kCollision;
  row.detector_disagreements = 2;
  row.detector_deepest_m = 3e-5;
  found.look(row);
  row.detector_deepest_m = 2e-5;
  row.lcp_messages = 4;
  found.look(row);
  row = {};
  row.outcome = Outcome::kError;
  found.look(row);
  row.outcome = Outcome::kSuccess;
  row.latency_base_off_s = -0.06;
  row.latency_joints_off_s = 0.02;
  found.look(row);
  found.look(row, true);  // its controller goes by what it finds
  row.latency_base_off_s = 0.0;
  row.latency_joints_off_s = 0.0;
  found.look(row);
  const std::vector<std::string> warnings = found.sentences();
  ASSERT_EQ(warnings.size(), 4u);
  EXPECT_NE(warnings[0].find("2 trials where the two detectors of contact disagree, by 3e-05 m"), std::string::npos)
      << warnings[0];
  EXPECT_NE(warnings[1].find("1 trial with messages"), std::string::npos) << warnings[1];
  EXPECT_NE(warnings[2].find("1 trial whose motion contradicts the latencies that the controller was told, by -0.06 s"),
            std::string::npos)
      << warnings[2];
  EXPECT_NE(warnings[3].find("outcome = 'error'"), std::string::npos) << warnings[3];
}

}  // namespace
}  // namespace moma::run
