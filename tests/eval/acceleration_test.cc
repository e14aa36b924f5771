// moma's presets keep their acceleration limits in every step of every trial: robots x families x presets. A joint's is
// 5 rad/s^2 (m/s^2), with `moma` 0.8 of its own where the robot file has that.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "eval/batch/batch.h"
#include "tests/eval/suite_fixture.h"

namespace moma::test {
namespace {

constexpr double kLimit = 5.0, kShare = 0.8;

struct Case {
  const char* robot;
  const char* simulation;
};

std::string name_of(const testing::TestParamInfo<Case>& info) {
  return std::string(info.param.robot) + "_" + info.param.simulation;
}

class PresetAcceleration : public testing::TestWithParam<Case> {};

TEST_P(PresetAcceleration, IsWithinItsLimitInEveryStep) {
  const std::string configs = MOMA_SOURCE_DIR "/configs/";
  const std::string simulation = GetParam().simulation;
  SuiteFolder folder;
  std::string text = "robot: " + configs + "robots/" + GetParam().robot + ".yaml\ncontrollers:\n";
  std::vector<std::string> presets = {"moma", "moma-safe"};
  // Without prediction a bound is about the measured velocity, whose noise is more than the bound lets a command
  // change.
  if (simulation == "kinematic") presets.emplace_back("moma-reactive");
  for (const std::string& preset : presets)
    text += "  " + preset + ": " + configs + "controllers/" + preset + ".yaml\n";
  if (simulation == "dynamic") text += "disturbances: " + configs + "disturbances/realistic.yaml\n";
  text += R"(
worlds: {seed: 11, families: {clutter: {weight: 2}, moving: {weight: 1}, open: {weight: 1}, tracking: {weight: 1}}}
simulation: {mode: )" +
          simulation + R"(, time_limit: 8}
trials: 5
)";
  const Suite suite = load_suite(folder.write("suite.yaml", text));
  std::size_t beyond = 0, trials = 0;
  run_batch(suite.points, make_jobs(suite.points, 0, suite.trials), {}, [&](const BatchJob& job, BatchResult&& result) {
    const TrialRow& row = result.output.row;
    ++trials;
    EXPECT_NE(row.outcome, Outcome::kError) << row.reason;
    EXPECT_GT(row.acceleration_max, 0.1 * kLimit) << "a trial in which nothing moves shows nothing";
    const SuitePoint& spec = suite.points[job.point];
    const RobotModel& model = *spec.robot->model;
    const Trace& trace = result.output.trace;
    EXPECT_EQ(trace.size(), static_cast<std::size_t>(row.steps));
    for (int i = 0; i < model.num_joints(); ++i) {
      const double own = model.joints[static_cast<std::size_t>(i)].acceleration;
      const double limit = spec.controller == "moma" && std::isfinite(own) ? kShare * own : kLimit;
      double most = 0.0;
      for (std::size_t k = 1; k < trace.size(); ++k) {
        const Eigen::Index at = model.base_dof() + i;
        most = std::max(most, std::abs(trace[k].command[at] - trace[k - 1].command[at]));
      }
      EXPECT_LE(most / spec.simulation.control_period, limit * (1.0 + 1e-9))
          << spec.controller << ", joint " << i << ", world " << job.world << ": " << row.fallback_no_acceleration
          << " no_acceleration, " << row.fallback_relaxed << " relaxed, " << row.fallback_brake << " brake";
    }
    beyond += row.fallback_relaxed + row.fallback_brake > 0 ? 1U : 0U;
    return true;
  });
  EXPECT_EQ(trials, 5 * presets.size());
  std::printf("%zu of %zu trials had a stage of the fallback\n", beyond, trials);
}

INSTANTIATE_TEST_SUITE_P(Robots, PresetAcceleration,
                         testing::Values(Case{"frankie", "kinematic"}, Case{"frankie_omni", "kinematic"},
                                         Case{"panda", "kinematic"}, Case{"ur5", "kinematic"},
                                         Case{"lift_ur5", "kinematic"}, Case{"frankie", "dynamic"},
                                         Case{"panda", "dynamic"}),
                         name_of);

}  // namespace
}  // namespace moma::test
