// The trace file: complete, in the documented form, and true to the kinematics it claims.
#include <gtest/gtest.h>

#include <cmath>

#include "eval/trial/trial.h"
#include "eval/trial/trial_detail.h"
#include "tests/eval/suite_fixture.h"
#include "world/world_json.h"

namespace moma::test {
namespace {

using nlohmann::ordered_json;

class TrialTrace : public ::testing::Test {
 protected:
  void SetUp() override {
    const Suite suite = load_suite(folder_.suite("", "{plain: {servo: {max_linear: 1}, limits: {acceleration: 5}}}"));
    const SuitePoint& point = suite.points[0];
    const World world = point.worlds.make(point.robot->model, 1);
    const TrialOutput output = run_trial(point, world);
    steps_ = output.row.steps;
    trace_ = ordered_json::parse(trace_json(point, world, output, "0123456789abcdef").dump());
    // Once more from what the trace holds.
    again_ = run_trial(point, world_from_json(trace_["world"], "trace")).row;
    row_ = output.row;
  }

  SuiteFolder folder_;
  ordered_json trace_;
  TrialRow row_, again_;
  int steps_ = 0;
};

TEST_F(TrialTrace, HoldsEverythingThatWasSimulated) {
  for (const char* key :
       {"trial", "outcome", "robot", "success", "stuck", "infeasible", "controller", "world", "simulation", "samples"})
    EXPECT_TRUE(trace_.contains(key)) << key;
  EXPECT_EQ(trace_["trial"], "0123456789abcdef");
  EXPECT_NE(trace_["robot"]["urdf_text"].get<std::string>().find("<robot"), std::string::npos);
  EXPECT_EQ(trace_["simulation"]["mode"], "kinematic");
  ASSERT_GT(steps_, 10);
  ASSERT_EQ(trace_["samples"].size(), static_cast<std::size_t>(steps_));
  const ordered_json& sample = trace_["samples"][3];
  for (const char* key : {"t", "base", "q", "qdot", "command", "error", "slack", "manipulability", "least_distance",
                          "status", "fallback"})
    EXPECT_TRUE(sample.contains(key)) << key;
  EXPECT_EQ(sample["base"].size(), 3u);
  EXPECT_EQ(sample["q"].size(), 3u);
  EXPECT_EQ(sample["command"].size(), 5u);
  EXPECT_EQ(sample["error"].size(), 6u);
  EXPECT_EQ(sample["status"], "solved");
  EXPECT_EQ(sample["least_distance"], "inf") << "an open world has no objects";
}

TEST_F(TrialTrace, EachStateFollowsFromTheOneBeforeAndItsCommand) {
  const double dt = 0.02;
  for (std::size_t k = 0; k + 1 < trace_["samples"].size(); ++k) {
    const ordered_json& now = trace_["samples"][k];
    const ordered_json& next = trace_["samples"][k + 1];
    EXPECT_NEAR(now["t"].get<double>(), dt * static_cast<double>(k), 1e-12);
    const double v = now["command"][0], w = now["command"][1], phi = now["base"][2];
    // The exact arc of constant speeds, written out: chord along the mean heading.
    const double half = 0.5 * w * dt;
    const double chord = v * dt * (std::abs(half) < 1e-12 ? 1.0 : std::sin(half) / half);
    EXPECT_NEAR(next["base"][0].get<double>(), now["base"][0].get<double>() + chord * std::cos(phi + half), 1e-12);
    EXPECT_NEAR(next["base"][1].get<double>(), now["base"][1].get<double>() + chord * std::sin(phi + half), 1e-12);
    EXPECT_NEAR(next["base"][2].get<double>(), phi + w * dt, 1e-12);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(next["q"][i].get<double>(), now["q"][i].get<double>() + dt * now["command"][2 + i].get<double>(),
                  1e-12);
    }
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(next["qdot"][i], now["command"][i]) << "the previous command";
  }
}

TEST_F(TrialTrace, TheWorldInItGivesTheSameTrial) {
  EXPECT_EQ(again_.outcome, row_.outcome);
  EXPECT_EQ(again_.steps, row_.steps);
  EXPECT_EQ(again_.path_ee_m, row_.path_ee_m);
  EXPECT_EQ(again_.jerk_joint_rms, row_.jerk_joint_rms);
}

}  // namespace
}  // namespace moma::test
