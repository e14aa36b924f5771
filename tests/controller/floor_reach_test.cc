#include "controller/model/floor_reach.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>

#include "controller/config/node.h"
#include "controller/config/robot_file.h"
#include "controller/model/kinematics.h"
#include "controller/model/sampling.h"
#include "tests/support/robots.h"

namespace moma {
namespace {

std::shared_ptr<const RobotModel> mounted(const std::string& robot, const std::string& mount) {
  const std::string text = "include: " + test::source_path("configs/robots/" + robot + ".yaml") +
                           "\nbase: {type: fixed, mount: " + mount + "}\n";
  return config::read_robot(config::parse_yaml(text, "mounted.yaml"), "").model;
}

/// By how much points of each link, 0.1 m from its frame along each axis, move up and down over two hundred
/// configurations, the most of them.
std::vector<double> travel(const std::shared_ptr<const RobotModel>& model) {
  Kinematics kinematics(model);
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::vector<Vector3> least(model->links.size(), Vector3::Constant(kFar)), most(least.size(), -least.front());
  for (int s = 1; s <= 200; ++s) {
    VectorX q(model->num_joints());
    for (int i = 0; i < q.size(); ++i) {
      const auto [lower, upper] = drawn_range(model->joints[static_cast<std::size_t>(i)]);
      q[i] = lower + (upper - lower) * halton_coordinate(s, i);
    }
    kinematics.update(Vector3::Zero(), q);
    for (std::size_t i = 0; i < least.size(); ++i) {
      const Isometry& X = kinematics.X_WL(static_cast<int>(i));
      const Vector3 heights = X.translation().z() * Vector3::Ones() + 0.1 * X.linear().row(2).transpose();
      least[i] = least[i].cwiseMin(heights);
      most[i] = most[i].cwiseMax(heights);
    }
  }
  std::vector<double> travel;
  for (std::size_t i = 0; i < least.size(); ++i) travel.push_back((most[i] - least[i]).maxCoeff());
  return travel;
}

TEST(FloorReach, WhatIsNeverLiftedKeepsItsHeight) {
  std::size_t kept = 0;
  for (const char* robot : {"frankie", "panda", "ur5", "lift_ur5"}) {
    const auto model = config::load_robot(test::source_path(std::string("configs/robots/") + robot + ".yaml")).model;
    const FloorReach reach = floor_reach(*model);
    const std::vector<double> by = travel(model);
    for (std::size_t i = 0; i < model->shapes.size(); ++i) {
      const double moved = by[static_cast<std::size_t>(model->shapes[i].link)];
      EXPECT_EQ(reach.lifted[i], moved > 1e-4) << robot << " " << model->shapes[i].name << " by " << moved;
      kept += reach.lifted[i] || model->shapes[i].rigid_with_base ? 0 : 1;
      EXPECT_TRUE(!model->shapes[i].rigid_with_base || reach.stands[i]);
    }
  }
  EXPECT_GE(kept, 1u) << "the first links of Panda and UR5 turn about the vertical";
}

TEST(FloorReach, ATiltedMountLetsTheFirstJointLift) {
  const auto upright = mounted("panda", "{position: [0, 0, 0.5]}");
  const auto tilted = mounted("panda", "{position: [0, 0, 0.5], rpy: [0.3, 0, 0]}");
  const int link = upright->find_link("panda_link1");
  std::size_t shapes = 0;
  for (std::size_t i = 0; i < upright->shapes.size(); ++i) {
    if (upright->shapes[i].link != link) continue;
    ++shapes;
    EXPECT_FALSE(floor_reach(*upright).lifted[i]);
    EXPECT_TRUE(floor_reach(*tilted).lifted[i]);
  }
  EXPECT_GT(shapes, 0u);
}

TEST(FloorReach, StandsWhatIsLowAndStaysLow) {
  // The Panda's first link hangs about 0.14 m over its root.
  const auto high = mounted("panda", "{position: [0, 0, 0]}");
  const auto sunk = mounted("panda", "{position: [0, 0, -0.2]}");
  for (std::size_t i = 0; i < high->shapes.size(); ++i) {
    const bool first = high->links[static_cast<std::size_t>(high->shapes[i].link)].name == "panda_link1";
    if (!first) continue;
    EXPECT_FALSE(floor_reach(*high).stands[i]);
    EXPECT_TRUE(floor_reach(*sunk).stands[i]);
  }
}

}  // namespace
}  // namespace moma
