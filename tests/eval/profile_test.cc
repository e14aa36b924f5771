// Profiles: every moment in one part, parts entered as often as there is work, and no bit of a result changed.
#include <gtest/gtest.h>

#include <chrono>
#include <map>

#include "eval/batch/batch.h"
#include "tests/eval/suite_fixture.h"
#include "tests/support/filled.h"

namespace moma::test {
namespace {

Suite demo(const std::string& mode) {
  return load_suite(MOMA_SOURCE_DIR "/configs/suites/demo.yaml", {{"simulation.mode", mode},
                                                                  {"simulation.time_limit", "1"},
                                                                  {"worlds.families", "{clutter: {objects: 5}}"},
                                                                  {"trials", "1"}});
}

std::string all_bits(const TrialOutput& output) {
  std::string text = own_bits_of(output.row);
  for (const Sample& sample : output.trace) text += bits_of(sample);
  return text;
}

TEST(Profile, EveryMomentBelongsToOnePart) {
  using Clock = std::chrono::steady_clock;
  const Suite suite = demo("kinematic");
  BatchOptions options;
  options.profile = true;
  const Clock::time_point before = Clock::now();
  const BatchResult result = compute_job(suite.points[0], {0, 0, ""}, options);
  const std::int64_t outside = std::chrono::nanoseconds(Clock::now() - before).count();
  // The trial lies within the profile, the profile within the call: whatever the machine does meanwhile.
  EXPECT_GE(static_cast<double>(result.profile.nanoseconds()) + 1.0, 1e3 * result.output.row.timing.t_trial_us);
  EXPECT_LE(result.profile.nanoseconds(), outside);
  for (const Profile::Share& share : result.profile.parts) EXPECT_GE(share.nanoseconds, 0);
}

TEST(Profile, TimeIsThatOfThePartThatIsOn) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kAtLeast{2};
  ProfileClock clock(TrialPart::kWorld);
  for (const TrialPart part : {TrialPart::kSolve, TrialPart::kStore, TrialPart::kSolve}) {
    clock.enter(part);
    for (const auto begin = Clock::now(); Clock::now() - begin < kAtLeast;) continue;
  }
  clock.enter(PlantPart::kStep);
  const Profile& profile = clock.stop();
  EXPECT_GE(profile[TrialPart::kSolve].nanoseconds, 2 * std::chrono::nanoseconds(kAtLeast).count());
  EXPECT_GE(profile[TrialPart::kStore].nanoseconds, std::chrono::nanoseconds(kAtLeast).count());
  EXPECT_EQ(profile[TrialPart::kSolve].entries, 2);
  EXPECT_EQ(profile[TrialPart::kStep].entries, 1);
  EXPECT_EQ(profile[TrialPart::kRows].nanoseconds, 0);
}

TEST(Profile, PartsBeginAsOftenAsThereIsWorkAndNoBitChanges) {
  for (const char* mode : {"kinematic", "dynamic"}) {
    const Suite suite = demo(mode);
    const bool dynamic = mode[0] == 'd';
    for (const SuitePoint& point : suite.points) {
      BatchOptions options;
      const BatchResult plain = compute_job(point, {0, 0, ""}, options);
      options.profile = true;
      const BatchResult told = compute_job(point, {0, 0, ""}, options);
      const std::string where = point.controller + " " + point.label + " " + mode;
      ASSERT_NE(told.output.row.outcome, Outcome::kError) << told.output.row.reason;
      EXPECT_EQ(all_bits(told.output), all_bits(plain.output)) << where;
      EXPECT_EQ(plain.profile.trials, 0) << where;
      EXPECT_EQ(plain.profile[TrialPart::kWorld].entries, 0) << where;

      const std::int64_t steps = told.output.row.steps;
      ASSERT_GT(steps, 0) << where;
      EXPECT_EQ(told.profile.trials, 1) << where;
      EXPECT_EQ(told.profile.steps, steps) << where;
      const std::map<TrialPart, std::int64_t> expected = {
          {TrialPart::kWorld, 1},          {TrialPart::kSetUp, 1},     {TrialPart::kSensing, 2 * steps},
          {TrialPart::kKinematics, steps}, {TrialPart::kSolve, steps}, {TrialPart::kDistances, steps},
          {TrialPart::kStore, 0}};
      for (const auto& [part, entries] : expected)
        EXPECT_EQ(told.profile[part].entries, entries) << where << ": " << to_string(part);
      const bool ahead = point.controller_params.plan.enabled;
      EXPECT_EQ(told.profile[TrialPart::kAhead].entries, ahead ? 2 * steps : 0) << where;
      // Two steps of physics in a period of control, more where they are divided.
      const std::int64_t physics = told.profile[TrialPart::kStep].entries;
      if (dynamic)
        EXPECT_GE(physics, 2 * steps) << where;
      else
        EXPECT_EQ(physics, 0) << where;
      EXPECT_GE(told.profile[TrialPart::kCollide].entries, dynamic ? 2 * steps : steps + 1) << where;
    }
  }
}

TEST(Profile, SumsPartByPart) {
  Profile a, b;
  a[TrialPart::kSolve] = {5, 1};
  a.trials = 1;
  a.steps = 3;
  b[TrialPart::kSolve] = {7, 2};
  b[TrialPart::kStore] = {11, 1};
  b.trials = 2;
  b.steps = 4;
  a += b;
  EXPECT_EQ(a[TrialPart::kSolve].nanoseconds, 12);
  EXPECT_EQ(a[TrialPart::kSolve].entries, 3);
  EXPECT_EQ(a[TrialPart::kStore].nanoseconds, 11);
  EXPECT_EQ(a.nanoseconds(), 23);
  EXPECT_EQ(a.trials, 3);
  EXPECT_EQ(a.steps, 7);
}

}  // namespace
}  // namespace moma::test
