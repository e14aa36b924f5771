// Scenes of benchmarks, pairs of random configurations, goals from above.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "controller/model/kinematics.h"
#include "tests/world/support.h"
#include "world/scenario/scenes.h"
#include "world/world_json.h"

namespace moma {
namespace {

using test::robot;
using test::worlds;

constexpr const char* kThree = R"(
scenes:
  joints: [panda_joint7, panda_joint1, panda_joint2, panda_joint3, panda_joint4, panda_joint5, panda_joint6]
  scenes:
    shelf:
      base: [0.5, -0.25, 1.5]
      boxes: {board: {size: [0.4, 0.3, 0.02], center: [0.1, 0.7, 0.5]}}
      configurations:
        - [0.7, 0.1, 0.2, 0.3, -1.4, 0.5, 1.6]
        - [0.8, 0, -0.2, 0.1, -1.5, 0.4, 1.7]
        - [0.9, -0.1, 0.3, 0, -1.6, 0.3, 1.8]
    bare:
      base: [0, 0, 0]
      boxes: {}
      configurations: [[0, 0, 0, 0, -1, 0, 1], [0.1, 0, 0, 0, -1, 0, 1]]
)";

TEST(Scenes, EveryUnorderedPairIsAProblem) {
  const auto model = robot("panda");
  const Worlds source = worlds(kThree);
  ASSERT_EQ(source.size(), 4);
  // By hand: joints are found by name, joint 7 stands first in the file.
  const std::vector<std::vector<double>> q = {
      {0.1, 0.2, 0.3, -1.4, 0.5, 1.6, 0.7}, {0, -0.2, 0.1, -1.5, 0.4, 1.7, 0.8}, {-0.1, 0.3, 0, -1.6, 0.3, 1.8, 0.9}};
  const std::vector<std::pair<int, int>> pairs = {{0, 1}, {0, 2}, {1, 2}};
  Kinematics kinematics(model);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const World world = source.make(model, i);
    EXPECT_EQ(world.family, "shelf");
    EXPECT_EQ(source.family_of(i), "shelf");
    EXPECT_EQ(world.start.base, Vector3(0.5, -0.25, 1.5));
    for (int j = 0; j < 7; ++j) {
      EXPECT_EQ(world.start.q[j], q[static_cast<std::size_t>(pairs[i].first)][static_cast<std::size_t>(j)]) << i;
      EXPECT_EQ(world.witness.q[j], q[static_cast<std::size_t>(pairs[i].second)][static_cast<std::size_t>(j)]) << i;
    }
    kinematics.update(world.start.base, world.witness.q);
    EXPECT_LT((kinematics.X_WE().matrix() - world.goal.X_WG.matrix()).norm(), 1e-12) << i;
    ASSERT_EQ(world.objects.size(), 1u);
    EXPECT_EQ(world.objects[0].X_WO.translation(), Vector3(0.1, 0.7, 0.5));
    EXPECT_EQ(world.objects[0].shape.size, Vector3(0.4, 0.3, 0.02));
  }
  EXPECT_EQ(source.make(model, 3).family, "bare");
  EXPECT_THROW(source.make(model, 4), GenerationError);
}

TEST(Scenes, AreReadAgainAsWritten) {
  const auto model = robot("panda");
  const Worlds source = worlds(kThree);
  const Worlds again = worlds(source.to_json().dump());
  EXPECT_EQ(again.to_json(), source.to_json());
  std::set<std::string> identities;
  for (std::uint64_t i = 0; i < 4; ++i) {
    EXPECT_EQ(to_json(again.make(model, i)).dump(), to_json(source.make(model, i)).dump());
    identities.insert(source.identity(i).dump());
    EXPECT_EQ(again.identity(i), source.identity(i));
  }
  EXPECT_EQ(identities.size(), 4u);
}

TEST(Scenes, TheBenchmarkHasAsManyProblemsAsWerePublished) {
  const Worlds source = worlds(std::string("scenes: ") + MOMA_SOURCE_DIR + "/configs/scenes/neo.yaml");
  ASSERT_EQ(source.size(), 198);
  std::map<std::string, int> problems;
  for (std::uint64_t i = 0; i < 198; ++i) ++problems[source.family_of(i)];
  EXPECT_EQ(problems,
            (std::map<std::string, int>{
                {"bookshelf", 45}, {"counter", 36}, {"industrial_a", 66}, {"industrial_b", 45}, {"tunnel", 6}}));
}

TEST(Scenes, MistakesAreNamed) {
  const std::string good = kThree;
  const auto message = [](const std::string& yaml) {
    try {
      worlds(yaml);
    } catch (const config::ConfigError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string all = good;
    return message(all.replace(all.find(from), from.size(), to));
  };
  ASSERT_EQ(message(good), "no error");
  for (const auto& [from, to, word] : std::vector<std::array<const char*, 3>>{
           {"panda_joint7, panda_joint1", "panda_joint7, panda_joint7", "'panda_joint7' is named twice"},
           {"size: [0.4, 0.3, 0.02]", "size: [0.4, 0, 0.02]", "worlds.scenes.scenes.shelf.boxes.board.size"},
           {"center: [0.1, 0.7, 0.5]", "centre: [0.1, 0.7, 0.5]",
            "worlds.scenes.scenes.shelf.boxes.board.center: missing"},
           {"- [0.8, 0, -0.2,", "- [0.8, 0,", "worlds.scenes.scenes.shelf.configurations[1]"},
           {"base: [0.5, -0.25, 1.5]", "base: [0.5, -0.25]", "worlds.scenes.scenes.shelf.base"},
           {"configurations: [[0, 0, 0, 0, -1, 0, 1], [0.1, 0, 0, 0, -1, 0, 1]]",
            "configurations: [[0, 0, 0, 0, -1, 0, 1]]", "two or more"}})
    EXPECT_NE(with(from, to).find(word), std::string::npos) << with(from, to);
  EXPECT_NE(message("scenes: nowhere.yaml").find("nowhere.yaml"), std::string::npos);
  try {
    worlds(kThree).make(robot("ur5"), 0);
    ADD_FAILURE() << "made for a robot without these joints";
  } catch (const GenerationError& error) {
    EXPECT_NE(std::string(error.what()).find("robot ur5"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("shoulder_pan_joint"), std::string::npos) << error.what();
  }
}

TEST(Pairs, StartAndWitnessAreOfTheMiddlePart) {
  const auto model = robot("bare/panda");
  const Worlds middle = worlds("families: {pairs: {range: 0.45, tip_height: -10}}");
  const Worlds whole = worlds("families: {pairs: {tip_height: -10}}");
  double furthest_middle = 0.0, furthest_whole = 0.0, alike = 0.0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const World a = middle.make(model, i);
    const World b = whole.make(model, i);
    for (int j = 0; j < model->num_joints(); ++j) {
      const ControlledJoint& joint = model->joints[static_cast<std::size_t>(j)];
      const double half = 0.5 * (joint.upper - joint.lower), at = 0.5 * (joint.upper + joint.lower);
      for (const VectorX* q : {&a.start.q, &a.witness.q})
        furthest_middle = std::max(furthest_middle, std::abs((*q)[j] - at) / half);
      furthest_whole = std::max(furthest_whole, std::abs(b.start.q[j] - at) / half);
    }
    alike += (a.start.q - a.witness.q).norm() < 1e-3 ? 1.0 : 0.0;
  }
  EXPECT_LE(furthest_middle, 0.45 + 1e-12);
  EXPECT_GT(furthest_middle, 0.44);
  EXPECT_GT(furthest_whole, 0.98);
  EXPECT_EQ(alike, 0.0) << "start and witness share their draws";
}

TEST(Around, ToolsPointDownBetweenTheHeights) {
  const auto model = robot("frankie");
  const Worlds source = worlds("families: {around: {distance: {uniform: [1, 5]}}}");
  for (std::uint64_t i = 0; i < 30; ++i) {
    const World world = source.make(model, i);
    EXPECT_GE(world.goal.X_WG.translation().z(), 0.3);
    EXPECT_LE(world.goal.X_WG.translation().z(), 0.9);
    EXPECT_LE(world.goal.X_WG.linear()(2, 2), -0.95 + 0.02) << "the Panda's hand reaches along its z";
  }
}

}  // namespace
}  // namespace moma
