// A case that was written is the step that was taken, to the last bit, whatever the controller remembers.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "controller/case/case_step.h"
#include "tests/controller/case_text.h"
#include "tests/controller/qp_robots.h"

namespace moma {
namespace {

using namespace test;
using Json = nlohmann::ordered_json;

TEST(CaseMemory, AStepIsRepeatedBitForBitFromItsFile) {
  int detours = 0;
  for (const std::string robot : {"frankie.yaml", "frankie_omni.yaml"}) {
    Rng rng(1);
    ControlCase c = case_of(robot, "moma-safe.yaml");
    c.controller.escape.patience = 1.0;  // the robot is moved elsewhere after two seconds
    c.objects = random_objects(rng, 5);
    ControllerCore controller(c.robot.model, c.controller, c.control_period);
    controller.reset(c.objects);
    StepResult result;
    controller.prepare(result);
    Observation o = random_observation(*c.robot.model, 5, rng, 1.0);
    for (int k = 0; k < 400; ++k) {
      if (k % 100 == 50) o = random_observation(*c.robot.model, 5, rng, 1.0);
      for (ObjectState& object : o.objects)
        if (k < 200) object.V_WO_W.setZero();
      o.objects[4].visible = k % 3 != 0;
      o.objects[1].covariance.reset();
      if (k % 2 == 1) {
        Matrix3 P = 1e-4 * Matrix3::Random();
        P = P * P.transpose().eval();
        o.objects[1].covariance = ObjectCovariance{P, 2.0 * P};
      }
      controller.get_memory(c.memory);
      c.observation = o;
      controller.step(o, result);
      detours += result.escape.detour ? 1 : 0;
      if (k % 40 != 7) continue;
      const ControlCase again = read_text(case_to_json(c));
      const CaseStep step(again);
      ASSERT_EQ(step.result.command, result.command) << robot << " step " << k;
      ASSERT_EQ(step.result.slack, result.slack) << robot << " step " << k;
      ASSERT_EQ(step.result.kept, result.kept) << robot << " step " << k;
      // Without what is remembered it is another step.
      ControlCase forgotten = again;
      forgotten.memory.prediction = {};
      const CaseStep other(forgotten);
      EXPECT_NE(other.result.command, result.command) << robot << " step " << k;
    }
  }
  EXPECT_GT(detours, 20);
}

// The time of a step tells that steps before it were missed, which counts: it is part of the case.
TEST(CaseMemory, AStepAfterMissedOnesIsRepeatedBitForBit) {
  Rng rng(3);
  ControlCase c = case_of("frankie.yaml", "moma-safe.yaml");
  c.objects = random_objects(rng, 3);
  ControllerCore controller(c.robot.model, c.controller, c.control_period);
  controller.reset(c.objects);
  StepResult result;
  controller.prepare(result);
  Observation o = random_observation(*c.robot.model, 3, rng, 1.0);
  o.objects[2].V_WO_W[3] = 0.3;
  int told = 0;
  for (int k = 0; k < 60; ++k) {
    const bool missed = k % 6 == 5;
    o.time += c.control_period * (missed ? 4 : 1);
    controller.get_memory(c.memory);
    c.observation = o;
    controller.step(o, result);
    if (!missed) continue;
    const ControlCase again = read_text(case_to_json(c));
    EXPECT_EQ(again.observation.time, o.time);
    ASSERT_EQ(CaseStep(again).result.command, result.command) << "step " << k;
    ControlCase timeless = again;
    timeless.observation.time = 0.0;
    if (CaseStep(timeless).result.command != result.command) ++told;
  }
  EXPECT_GT(told, 5);
}

TEST(CaseMemory, IsRefusedWhereItIsAnotherControllers) {
  Rng rng(2);
  ControlCase c = case_of("frankie.yaml", "moma-safe.yaml");
  c.objects = random_objects(rng, 2);
  ControllerCore controller(c.robot.model, c.controller, c.control_period);
  controller.reset(c.objects);
  controller.get_memory(c.memory);
  c.observation = random_observation(*c.robot.model, 2, rng, 1.0);
  const Json good = case_to_json(c);
  ASSERT_EQ(error_of(good), "");
  Json bad = good;
  bad["state"]["prediction"]["sent"].erase(0);
  EXPECT_NE(error_of(bad).find("sent has 13 entries, expected 14"), std::string::npos) << error_of(bad);
  bad = good;
  bad["state"]["prediction"]["sent"][3].erase(0);
  EXPECT_NE(error_of(bad).find("each command has 8 entries, expected 9"), std::string::npos) << error_of(bad);
  bad = good;
  bad["state"]["prediction"]["base_trip"]["periods"] = 12;
  EXPECT_NE(error_of(bad).find("periods is 12, expected 0 to 11"), std::string::npos) << error_of(bad);
  bad = good;
  bad["objects"].erase(1);
  EXPECT_NE(error_of(bad).find("objects has 2 entries, expected 1"), std::string::npos) << error_of(bad);
  bad = good;
  bad["controller"].erase("prediction");
  EXPECT_NE(error_of(bad).find("the controller has no `prediction`"), std::string::npos) << error_of(bad);
  bad = good;
  bad["objects"][0]["covariance"] = {{"position", {1, 0, 0, 0, 1, 0, 0, 0, 1}},
                                     {"velocity", {0, 0, 0, 0, 0, 0, 0, 0, 0}}};
  EXPECT_EQ(error_of(bad), "");
  bad["objects"][0]["covariance"]["position"][4] = -1;
  EXPECT_NE(error_of(bad).find("objects[0].covariance.position"), std::string::npos) << error_of(bad);
  EXPECT_NE(error_of(bad).find("without negative eigenvalues"), std::string::npos) << error_of(bad);
  bad["objects"][0]["covariance"]["position"][4] = 1;
  bad["objects"][0]["covariance"]["position"][1] = 0.5;
  EXPECT_NE(error_of(bad).find("a symmetric matrix"), std::string::npos) << error_of(bad);
  bad["objects"][0]["covariance"].erase("velocity");
  bad["objects"][0]["covariance"]["position"][1] = 0;
  EXPECT_NE(error_of(bad).find("objects[0].covariance"), std::string::npos) << error_of(bad);
  bad = good;
  bad["goal"]["rotation"][0] = 0.2;
  EXPECT_NE(error_of(bad).find("expected a rotation matrix"), std::string::npos) << error_of(bad);
}

}  // namespace
}  // namespace moma
