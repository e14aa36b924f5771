#include "eval/run/warnings.h"

#include <gtest/gtest.h>

#include "tests/support/scratch.h"

namespace moma {
namespace {

const std::string kRobots = std::string(MOMA_SOURCE_DIR) + "/configs/robots/";

config::LoadedRobot frankie(const std::string& wheels) {
  const test::Scratch scratch;
  return config::load_robot(scratch.write(
      "robot.yaml", "include: " + kRobots +
                        "panda.yaml\nbase: {type: differential, max_linear: 1, max_angular: 1, wheels: {radius: 0.1, "
                        "separation: 0.5" +
                        wheels +
                        "}, footprint: {shape: box, size: [0.6, 0.4, 0.3], position: [0, 0, 0.2], mass: 90}}\n"));
}

TEST(Reach, WheelsBesideTheFootprintAreSaid) {
  const config::LoadedRobot narrow = frankie("");
  const auto warnings = run::wheel_warnings(*narrow.model);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("50 mm"), std::string::npos) << warnings[0];

  const config::LoadedRobot wide = frankie(", width: 0.06");
  EXPECT_TRUE(run::wheel_warnings(*wide.model).empty());
  ASSERT_EQ(wide.model->shapes.size(), narrow.model->shapes.size() + 2);
  const CollisionShape& left = wide.model->shapes[1];
  EXPECT_EQ(left.link, 0);
  EXPECT_EQ(left.shape.size, Vector3(0.2, 0.06, 0.2));
  EXPECT_EQ(left.X_LS.translation(), Vector3(0.0, 0.25, 0.1));
  EXPECT_EQ(wide.model->shapes[2].X_LS.translation(), Vector3(0.0, -0.25, 0.1));
  const config::LoadedRobot again = config::robot_from_resolved(wide.resolved);
  EXPECT_EQ(again.model->shapes.size(), wide.model->shapes.size());
  EXPECT_EQ(again.resolved.dump(), wide.resolved.dump());
}

TEST(Reach, LinksThatLookLargerThanTheirShapesAreSaid) {
  const std::string ur5 = kRobots + "examples/ur5.yaml";
  EXPECT_TRUE(run::visual_warnings(ur5, *config::load_robot(ur5).model).empty());
  const test::Scratch scratch;
  const auto thin = scratch.write(
      "thin.yaml",
      "include: " + ur5 + "\ncollision: {from: urdf, shapes: [{link: forearm_link, shape: sphere, size: 0.01}]}\n");
  const auto warnings = run::visual_warnings(thin, *config::load_robot(thin).model);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("1 of "), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find(": forearm_link by "), std::string::npos) << warnings[0];
}

}  // namespace
}  // namespace moma
