#include "controller/draft/draft_robot.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "controller/config/node.h"
#include "controller/model/kinematics.h"
#include "controller/model/proximity.h"
#include "controller/model/statics.h"
#include "tests/controller/draft_robots.h"

namespace moma::draft {
namespace {

TEST_F(Drafts, ATipBeforeFingersGetsATool) {
  std::string parts = body() + arm("base_link", "", "0 0 0.3");
  const std::string tool = "tool0";
  for (std::size_t at = 0; (at = parts.find(tool, at)) != std::string::npos;) parts.replace(at, tool.size(), "plate");
  for (std::size_t at = 0; (at = parts.find("0.01 0.02 0.05", at)) != std::string::npos; ++at)
    parts.replace(at, 14, "0.01 0.02 0.15");
  const Draft made = draft(parts);
  // The fingers reach from the hand's base 0.05 + 0.075 m ahead.
  EXPECT_TRUE(says(made, "tip: hand_base"));
  EXPECT_TRUE(says(made, "tool: {position: [0, 0, 0.113]}  # check: between the fingertips"));
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
  EXPECT_TRUE(says(made, "packages:\n  arm_support: arm_description  # check: a folder of another name"));
  EXPECT_FALSE(load(made).model->shapes.empty());
  // Found by the environment, which whoever reads the robot file may not have.
  fs::create_directory(folder_ / "elsewhere");
  fs::rename(folder_ / "arm_description" / "meshes", folder_ / "elsewhere" / "meshes");
  fs::create_directory(folder_ / "workspace");
  fs::rename(folder_ / "elsewhere", folder_ / "workspace" / "arm_support");
  ASSERT_EQ(::setenv("MOMA_PACKAGE_PATH", (folder_ / "workspace").c_str(), 1), 0);
  const Draft found = draft_robot({file, folder_, false});
  ::unsetenv("MOMA_PACKAGE_PATH");
  EXPECT_TRUE(says(found, "packages:\n  arm_support: workspace/arm_support\n"));
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
  EXPECT_TRUE(says(made, "tip: right_tool0  # check: left_tool0 would be as long"));
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
    EXPECT_TRUE(says(made, "left_j" + std::to_string(i) + ": "));
  }
  EXPECT_TRUE(says(made, "locked:  # check: the arm that is not used is held out of the way"));
  RobotModel at_zero = *robot.model;
  for (Link& link : at_zero.links)
    if (link.name.rfind("left_", 0) == 0) link.held = 0.0;
  const auto [ahead, out] = spread_of(*robot.model, "left_");
  const auto [ahead_at_zero, out_at_zero] = spread_of(at_zero, "left_");
  EXPECT_GT(ahead_at_zero, 0.9);
  EXPECT_LT(ahead, 0.5 * ahead_at_zero) << made.text;
  EXPECT_LT(out, out_at_zero);
  // Neither arm touches the other, at `ready` or on average in the way.
  EXPECT_FALSE(says(made, "no posture"));
  EXPECT_EQ(made.text, draft_robot({folder_ / "robot.urdf", folder_, false}).text);
}

TEST_F(Drafts, SaysThatNoPostureIsClear) {
  const std::string wheels = wheel("left_wheel", "0 0.25 0") + wheel("right_wheel", "0 -0.25 0");
  const auto warned = [&](const std::string& mount) {
    const Draft made = draft_robot({urdf(body() + wheels + arm("base_link", "", mount)), folder_, false});
    return std::any_of(made.warnings.begin(), made.warnings.end(),
                       [](const std::string& text) { return text.starts_with("arm.ready: in every posture"); });
  };
  EXPECT_FALSE(warned("0 0 0.3"));
  EXPECT_TRUE(warned("0 0 -3")) << "an arm in the floor";
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
  EXPECT_FALSE(says(made, "mount"));
}

TEST_F(Drafts, WhatTheUrdfDoesNotSayIsProposedAndMarked) {
  std::string parts = body() + arm("base_link", "", "0 0 0.3");
  const auto replace = [&](const std::string& from, const std::string& to) {
    const std::size_t at = parts.find(from, parts.find("name='j2'"));
    parts.replace(at, from.size(), to);
  };
  replace(kLimit, "<limit lower='0' upper='0' velocity='0' effort='60'/>");
  const Draft made = draft(parts);
  EXPECT_TRUE(says(made, "j2: {lower: -3.14, upper: 3.14, velocity: 1}  # check"));
  EXPECT_NEAR(load(made).model->joints[1].velocity, 1.0, 1e-12);
}

TEST_F(Drafts, AShoulderTooWeakForItsArmMayHaveSprings) {
  const Draft strong = draft(body() + arm("base_link", "", "0 0 0.8"));
  EXPECT_FALSE(says(strong, "springs"));
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

// Robots that nobody prepared: read, with a posture that is clear and held, and nothing far apart in touch. Larger
// ones: the test robots_are_drafted.
class Unprepared : public ::testing::TestWithParam<const char*> {};

TEST_P(Unprepared, HasAFirstFile) {
  fs::path file;
  for (const auto& python : fs::directory_iterator(fs::path(MOMA_SOURCE_DIR) / ".venv/lib")) {
    const fs::path robots = python.path() / "site-packages/cmeel.prefix/share/example-robot-data/robots";
    if (fs::exists(robots / GetParam())) file = robots / GetParam();
  }
  ASSERT_FALSE(file.empty()) << "scripts/setup.sh fetches example-robot-data";
  const Draft made = draft_robot({file, file.parent_path(), true});
  EXPECT_FALSE(says(made, "no posture"));
  const fs::path as = file.parent_path() / "drafted.yaml";
  const config::LoadedRobot robot = config::read_robot(config::parse_yaml(made.text, as.string()), "");
  EXPECT_GE(robot.model->num_joints(), 5) << made.text;
  EXPECT_LE(robot.model->num_joints(), 9) << made.text;
  EXPECT_FALSE(robot.model->self_pairs.empty());
}

INSTANTIATE_TEST_SUITE_P(Robots, Unprepared,
                         ::testing::Values("panda_description/urdf/panda.urdf", "ur_description/urdf/ur5_robot.urdf",
                                           "tiago_description/robots/tiago.urdf", "so_arm_description/urdf/so101.urdf"),
                         [](const auto& robot) { return fs::path(robot.param).stem().string(); });

}  // namespace
}  // namespace moma::draft
