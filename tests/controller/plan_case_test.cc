// A case of a robot that looks ahead: its step is repeated to the last bit, whatever it is about; bad files are
// refused; what it will do is foreseen as it does it.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "controller/case/case_step.h"
#include "controller/case/plan_words.h"
#include "controller/case/solve.h"
#include "controller/controller_core.h"
#include "controller/lookahead/lookahead.h"
#include "tests/controller/case_text.h"
#include "tests/controller/plan_scenes.h"
#include "tests/support/filled.h"

namespace moma::test {
namespace {

using Json = nlohmann::ordered_json;

ControlCase ahead_case(const std::string& controller) {
  ControlCase c = case_of("frankie.yaml", controller);
  c.has_plan = true;
  return c;
}

/// A robot that does what it is told, behind a wall.
class Drive {
 public:
  Drive(ControlCase& control_case, std::uint64_t seed, bool passes = false) : case_(control_case) {
    const Scene scene = behind_a_wall(case_.robot.model, seed);
    case_.objects = scene.shapes;
    controller_ = std::make_unique<ControllerCore>(case_.robot.model, case_.controller, case_.control_period);
    controller_->reset(case_.objects);
    controller_->prepare(result);
    o_.base = scene.start.head<3>();
    o_.q = scene.start.tail(case_.robot.model->num_joints());
    o_.qdot = VectorX::Zero(case_.robot.model->num_velocities());
    // No rotation that a quaternion gives back.
    o_.goal.X_WG = scene.X_WG;
    o_.goal.X_WG.linear() *= Eigen::AngleAxisd(0.3, Vector3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
    o_.objects = scene.states;
    if (!passes) return;
    o_.goal.stop = false;
    o_.next = GoalState{o_.goal.X_WG};
    o_.next->X_WG.translation() += Vector3(0.3, 0.6, 0.1);
  }
  /// One step; the case is that of its beginning.
  void step() {
    controller_->get_memory(case_.memory);
    case_.observation = o_;
    controller_->step(o_, result);
    integrate(*case_.robot.model, o_.base, o_.q, result.command, case_.control_period);
    o_.qdot = result.command;
    o_.time += case_.control_period;
  }
  StepResult result;

 private:
  ControlCase& case_;
  std::unique_ptr<ControllerCore> controller_;
  Observation o_;
};

TEST(PlanCase, AStepIsRepeatedBitForBitInEveryMode) {
  std::map<PlanMode, int> modes;
  int going_on = 0, passing = 0;
  for (const std::string controller : {"moma-ahead.yaml", "moma.yaml"}) {
    for (const int budget : {30, 900}) {
      ControlCase c = ahead_case(controller);
      c.controller.plan.budget = budget;
      Drive drive(c, 1, budget == 900);
      for (int k = 0; k < 250; ++k) {
        drive.step();
        if (k > 10 && k % 5 != 0) continue;
        ++modes[c.memory.plan.brief.mode];
        going_on += c.memory.plan.brief.going_on ? 1 : 0;
        passing += c.memory.plan.path.passes() ? 1 : 0;
        const ControlCase again = read_text(case_to_json(c));
        ASSERT_EQ((again.memory.plan.X_WG.matrix() - c.memory.plan.X_WG.matrix()).norm(), 0.0) << "step " << k;
        ASSERT_EQ(bits_of(again.memory.plan.brief), bits_of(c.memory.plan.brief)) << "step " << k;
        if (c.memory.plan.path.count > 0) {
          ASSERT_EQ((again.memory.plan.path.X_WG.matrix() - c.memory.plan.path.X_WG.matrix()).norm(), 0.0);
        }
        const CaseStep step(again);
        ASSERT_EQ(step.result.command, drive.result.command)
            << controller << " step " << k << " in " << to_string(c.memory.plan.brief.mode);
      }
    }
  }
  for (const PlanMode mode : {PlanMode::kSetOut, PlanMode::kDirect, PlanMode::kFollow, PlanMode::kChoose})
    EXPECT_GT(modes[mode], 0) << to_string(mode);
  EXPECT_GT(going_on, 0);
  EXPECT_GT(passing, 0);
}

TEST(PlanCase, IsRefusedWhereItIsNone) {
  ControlCase c = ahead_case("moma-ahead.yaml");
  Drive drive(c, 1);
  for (int k = 0; k < 400 && c.memory.plan.brief.mode != PlanMode::kFollow; ++k) drive.step();
  ASSERT_EQ(c.memory.plan.brief.mode, PlanMode::kFollow);
  const Json good = case_to_json(c);
  ASSERT_EQ(error_of(good), "");
  const auto expect = [&](const std::string& words, const auto& change) {
    Json bad = good;
    change(bad["state"]["plan"]);
    const std::string error = error_of(bad);
    EXPECT_NE(error.find(words), std::string::npos) << words << "\n" << error;
  };
  expect("follow needs a path", [](Json& plan) { plan.erase("path"); });
  expect("state.plan.mode", [](Json& plan) { plan["mode"] = "flies"; });
  expect("state.plan.path.motions", [](Json& plan) { plan["path"]["motions"] = Json::array(); });
  expect("no more than `time`", [](Json& plan) { plan["path"]["motions"][0]["rise"] = 100.0; });
  expect("expected 10: x, y, phi", [](Json& plan) { plan["path"]["motions"][0]["change"].erase(0); });
  expect("path.origin: missing; expected a value for x, y, phi", [](Json& plan) { plan["path"].erase("origin"); });
  expect("path.goal: missing; expected a pose", [](Json& plan) { plan["path"].erase("goal"); });
  expect("state.plan.goal", [](Json& plan) { plan["goal"].erase("rotation"); });
  expect("expected a rotation matrix", [](Json& plan) { plan["path"]["goal"]["rotation"][0] = 3.0; });
  expect("state.plan.commit", [](Json& plan) { plan["commit"] = -1; });
  Json off = good;
  off["controller"]["plan"]["enabled"] = false;
  EXPECT_NE(error_of(off).find("does not look ahead"), std::string::npos) << error_of(off);
}

// The choice that is told is the one that the controller makes, and its candidates are told with why they were not it.
TEST(PlanCase, TheChoiceIsToldInWords) {
  ControlCase c = ahead_case("moma-ahead.yaml");
  Drive drive(c, 1);
  drive.step();
  ControlCase first = c;
  const CaseStep begun(first);
  const std::string before = describe_plan(first, begun.controller);
  EXPECT_EQ(before.find("The last choice"), std::string::npos) << before;
  for (int k = 0; k < 400 && c.memory.plan.brief.mode != PlanMode::kFollow; ++k) drive.step();
  const PlanVerdict& choice = c.memory.plan.brief.choice;
  ASSERT_EQ(choice.kind, PlanKind::kPath);
  const CaseStep step(c);
  const std::string told = describe_plan(c, step.controller);
  char time[60];
  std::snprintf(time, sizeof time, "fell on a path: %.2f s to the goal", choice.by_path);
  EXPECT_NE(told.find(time), std::string::npos) << told;
  EXPECT_NE(told.find("The policy as it was: would not have arrived"), std::string::npos) << told;
  EXPECT_NE(told.find("follows a path"), std::string::npos) << told;
  EXPECT_NE(told.find("Of a choice made now"), std::string::npos) << told;
  // At the beginning the wall is in the policy's way, and the path that is found then is the quicker one.
  EXPECT_NE(before.find("the policy as it is: stagnates"), std::string::npos) << before;
  const auto path = before.find("  a path: arrives after");
  ASSERT_NE(path, std::string::npos) << before;
  EXPECT_NE(before.find("the quicker one", path), std::string::npos) << before;
  ControlCase plain = c;
  plain.controller.plan.enabled = false;
  plain.has_plan = false;
  EXPECT_EQ(describe_plan(plain, CaseStep(plain).controller), "");
}

}  // namespace
}  // namespace moma::test
