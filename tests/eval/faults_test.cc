// Faults inside a physics step: each ends one trial, with its outcome and a reason, and leaves every other trial of
// the batch as it would have been, bit for bit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "eval/batch/batch.h"
#include "tests/eval/suite_fixture.h"
#include "tests/support/ode_faults.h"

namespace moma::test {
namespace {

constexpr int kTrials = 4;
constexpr int kStruck = 1;
constexpr int kStep = 246;  // the 13th control step: at 0.247 s

std::vector<TrialOutput> run_trials(const std::string& robot, OdeFault fault = {}) {
  SuiteFolder folder;
  // No step is taken back, so that what is done to bodies stays done: steps of 1 ms are not divided near contact, and
  // no motor meets its limit.
  std::string limits;
  for (int i = 1; i <= 7; ++i) limits += fmt::format("{}panda_joint{}: {{effort: 1e5}}", i > 1 ? ", " : "", i);
  folder.write("strong_frankie.yaml", fmt::format(R"(
include: {0}/configs/robots/frankie.yaml
arm: {{limits: {{{1}}}}}
)",
                                                  MOMA_SOURCE_DIR, limits));
  folder.write("low_frankie.yaml", R"(
include: strong_frankie.yaml
base: {footprint: {shape: box, size: [0.8, 0.6, 0.3], position: [0, 0, 0.153], mass: 90}}
)");
  const Suite suite = load_suite(folder.write("faults.yaml", fmt::format(R"(
robot: {2}
controllers: {{holistic: {0}/configs/controllers/holistic.yaml}}
worlds: {{seed: 5, families: {{open: {{weight: 1}}, moving: {{weight: 1}}}}}}
simulation: {{mode: dynamic, physics_step: 0.001, time_limit: 1}}
success: {{dwell: 0.2}}
trials: {1}
)",
                                                                         MOMA_SOURCE_DIR, kTrials, robot)));
  arm(std::move(fault));  // reading the suite makes a robot of its own
  std::vector<TrialOutput> out;
  BatchOptions options;
  options.threads = 1;
  run_batch(suite.points, make_jobs(suite.points, 0, suite.trials), options,
            [&](const BatchJob&, BatchResult&& result) {
              out.push_back(std::move(result.output));
              return true;
            });
  return out;
}

const std::string kFrankie = "strong_frankie.yaml";

/// Where the first command after the fault would have been given: the end of the struck control step.
constexpr double kEnd = 0.26;

class Faults : public testing::Test {
 protected:
  static void SetUpTestSuite() { usual_ = run_trials(kFrankie); }
  static void TearDownTestSuite() { usual_.clear(); }

  TrialRow strike(std::function<int(dWorldID)> act, bool others_are_known = true) {
    const std::vector<TrialOutput> outputs = run_trials(robot_, {kStruck, kStep, std::move(act)});
    EXPECT_TRUE(fault_happened());
    arm({});
    EXPECT_EQ(outputs.size(), usual_.size());
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      if (i == kStruck || !others_are_known) continue;
      EXPECT_EQ(outputs[i].row.outcome, usual_[i].row.outcome) << "trial " << i;
      EXPECT_EQ(outputs[i].row.energy_j, usual_[i].row.energy_j) << "trial " << i;
      EXPECT_EQ(outputs[i].trace.size(), usual_[i].trace.size()) << "trial " << i;
      const std::size_t n = std::min(outputs[i].trace.size(), usual_[i].trace.size());
      for (std::size_t k = 0; k < n; ++k)
        if (outputs[i].trace[k].q != usual_[i].trace[k].q || outputs[i].trace[k].base != usual_[i].trace[k].base) {
          ADD_FAILURE() << "trial " << i << " is another one from step " << k;
          break;
        }
    }
    return outputs.size() > kStruck ? outputs[kStruck].row : TrialRow();
  }

  static void expect_end(const TrialRow& row, Outcome outcome, const char* reason) {
    EXPECT_EQ(row.outcome, outcome) << to_string(row.outcome) << ": " << row.reason;
    EXPECT_NE(row.reason.find(reason), std::string::npos) << row.reason;
    EXPECT_DOUBLE_EQ(row.time_end_s, kEnd);
    // What was measured until then is kept, and is finite.
    EXPECT_EQ(row.steps, 13);
    for (const double value : {row.position_error_m, row.path_ee_m, row.manip_min, row.energy_j, row.slip_max_m_s})
      EXPECT_TRUE(std::isfinite(value)) << value;
    EXPECT_LT(row.path_base_m, 1.0);
  }

  static std::vector<TrialOutput> usual_;
  std::string robot_ = kFrankie;
};
std::vector<TrialOutput> Faults::usual_;

/// The whole robot turned over its right side.
void lean(double angle) {
  dMatrix3 R;
  dRFromAxisAndAngle(R, 1.0, 0.0, 0.0, angle);
  constexpr double kEdge = -0.5;  // y: beside the robot, so that nothing goes into the floor
  each_body([&](dBodyID body) {
    const dReal* p = dBodyGetPosition(body);
    const double y = p[1] - kEdge, z = p[2];
    dBodySetPosition(body, p[0], kEdge + R[5] * y + R[6] * z, R[9] * y + R[10] * z);
    dMatrix3 turned;
    dMultiply0_333(turned, R, dBodyGetRotation(body));
    dBodySetRotation(body, turned);
  });
}

void lower(double by) {
  each_body([&](dBodyID body) {
    const dReal* p = dBodyGetPosition(body);
    dBodySetPosition(body, p[0], p[1], p[2] - by);
  });
}

TEST_F(Faults, TheTrialToBeStruckWouldHaveGoneOn) {
  ASSERT_EQ(usual_.size(), static_cast<std::size_t>(kTrials));
  EXPECT_GT(usual_[kStruck].row.time_end_s, 0.5) << usual_[kStruck].row.reason;
  for (const TrialOutput& output : usual_) EXPECT_NE(output.row.outcome, Outcome::kError) << output.row.reason;
}

TEST_F(Faults, AVelocityThatIsNotANumber) {
  expect_end(strike([](dWorldID) {
               each_body([](dBodyID b) { dBodySetLinearVel(b, std::numeric_limits<double>::quiet_NaN(), 0, 0); });
               return 1;
             }),
             Outcome::kDiverged, "not finite");
}

TEST_F(Faults, APlaceThatIsInfinite) {
  expect_end(strike([](dWorldID) {
               each_body([](dBodyID b) { dBodySetPosition(b, std::numeric_limits<double>::infinity(), 0, 0); });
               return 1;
             }),
             Outcome::kDiverged, "not finite");
}

TEST_F(Faults, ABodyThatIsThrown) {
  expect_end(strike([](dWorldID) {
               each_body([](dBodyID b) { dBodySetLinearVel(b, 0, 0, 25.0); });
               return 1;
             }),
             Outcome::kDiverged, "20 m/s");
}

TEST_F(Faults, AStepThatGivesUp) {
  expect_end(strike([](dWorldID) { return 0; }), Outcome::kDiverged, "gave up");
}

TEST_F(Faults, AnInternalErrorOfOde) {
  expect_end(strike([](dWorldID) {
               dDebug(d_ERR_IASSERT, "assertion in a step");
               return 1;
             }),
             Outcome::kDiverged, "assertion in a step");
}

TEST_F(Faults, ABaseThatTipsOver) {
  expect_end(strike([](dWorldID) {
               lean(0.8);
               return 1;
             }),
             Outcome::kTipped, "30 degrees");
}

TEST_F(Faults, ABaseThatSinksIntoTheFloor) {
  const auto sink = [](dWorldID) {
    lower(0.2);
    return 1;
  };
  expect_end(strike(sink), Outcome::kCollision, "@base touches floor");
  // A base that stands close above the floor by design is not checked against it; its height is.
  robot_ = "low_frankie.yaml";
  expect_end(strike(sink, false), Outcome::kTipped, "below the floor");
}

TEST_F(Faults, MessagesOfTheLcpSolverAreCountedAndEndNothing) {
  const TrialRow row = strike([](dWorldID) {
    for (int i = 0; i < 3; ++i) dMessage(d_ERR_LCP, "LCP internal error, s <= 0 (s=%.4e)", 0.0);
    return 1;
  });
  EXPECT_EQ(row.outcome, usual_[kStruck].row.outcome);
  EXPECT_EQ(row.energy_j, usual_[kStruck].row.energy_j);
  EXPECT_EQ(row.lcp_messages, 3);
  EXPECT_EQ(usual_[kStruck].row.lcp_messages, 0);
}

}  // namespace
}  // namespace moma::test
