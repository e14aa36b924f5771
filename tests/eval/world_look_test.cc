// Warnings of `moma check` about worlds that others made: starts in touch, and goals nearer to objects than a
// controller keeps.
#include "eval/run/survey.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "controller/model/kinematics.h"
#include "eval/run/survey.h"
#include "tests/support/scratch.h"
#include "world/world_json.h"

namespace moma {
namespace {

const std::string kConfigs = std::string(MOMA_SOURCE_DIR) + "/configs/";

/// The Panda with its tool pointing down at a goal; a ball below it, `gap` from the nearest of the hand.
class WorldLooks : public ::testing::Test {
 protected:
  WorldLooks() {
    model_ = config::load_robot(kConfigs + "robots/panda.yaml").model;
    world_.family = "by-hand";
    world_.robot = model_->name;
    world_.start.q = world_.witness.q = model_->ready;
    world_.witness.q[0] = 1.2;
  }

  Isometry at_witness() const {
    Kinematics kinematics(model_);
    kinematics.update(world_.witness.base, world_.witness.q);
    return kinematics.X_WE();
  }

  /// Of the hand at the witness from a ball whose centre is so far along the tool's axis.
  double gap_at(double along) const {
    Kinematics kinematics(model_);
    kinematics.update(world_.witness.base, world_.witness.q);
    Isometry X_WO = Isometry::Identity();
    X_WO.translation() = kinematics.X_WE() * Vector3(0.0, 0.0, along);
    double least = 1.0;
    for (const CollisionShape& shape : model_->shapes)
      least = std::min(least, shape_distance(shape.shape, kinematics.X_WS(shape), ball(), X_WO).d);
    return least;
  }
  static Shape ball() { return {ShapeKind::kSphere, Vector3(0.05, 0.0, 0.0), nullptr}; }

  World world(std::uint64_t index, double gap) const {
    World out = world_;
    out.index = index;
    const Isometry X_WE = at_witness();
    set_pose(out.goal, X_WE.translation(), Eigen::Quaterniond(X_WE.linear()).normalized());
    double near = -0.2, far = 0.6;
    for (int i = 0; i < 60; ++i) (gap_at(0.5 * (near + far)) < gap ? near : far) = 0.5 * (near + far);
    WorldObject object;
    object.name = "ball";
    object.shape = ball();
    set_pose(object, X_WE * Vector3(0.0, 0.0, far), Eigen::Quaterniond::Identity());
    out.objects.push_back(object);
    return out;
  }

  /// The same with a ball in the forearm at the start.
  World touching(std::uint64_t index) const {
    World out = world(index, 0.2);
    Kinematics kinematics(model_);
    kinematics.update(out.start.base, out.start.q);
    set_pose(out.objects[0], kinematics.X_WL(model_->joints[4].link).translation(), Eigen::Quaterniond::Identity());
    return out;
  }

  Suite suite(const std::vector<World>& worlds, const std::string& success, const std::string& more = "") const {
    std::string lines;
    for (const World& w : worlds) lines += to_json(w).dump() + "\n";
    scratch_.write("worlds.jsonl", lines);
    return load_suite(scratch_.write(
        "suite.yaml", "name: others\nrobot: " + kConfigs + "robots/panda.yaml\n" + "controllers: {moma: " + kConfigs +
                          "controllers/moma.yaml, " + "neo: " + kConfigs + "controllers/neo.yaml}\n" +
                          "worlds: {frozen: worlds.jsonl}\n" +
                          "simulation: {mode: kinematic, time_limit: 4}\nsuccess: " + success +
                          "\ntrials: " + std::to_string(worlds.size()) + "\n" + more));
  }

  static std::vector<std::string> doubts(const Suite& suite) {
    run::WorldSurvey survey;
    survey.make_worlds(suite.points, 100, suite.trials);
    EXPECT_TRUE(survey.failures().empty());
    return survey.doubts();
  }

  static long mention(const std::vector<std::string>& texts, const std::string& words) {
    return std::count_if(texts.begin(), texts.end(),
                         [&](const std::string& text) { return text.find(words) != std::string::npos; });
  }

  test::Scratch scratch_;
  std::shared_ptr<const RobotModel> model_;
  World world_;
};

TEST_F(WorldLooks, GapsAreThoseOfTheToolAtTheGoalWhereverTheArmIs) {
  for (const double gap : {0.005, 0.04}) {
    run::WorldLook look;
    run::look_at(world(3, gap), model_, look);
    ASSERT_EQ(look.goals.size(), 1U);
    EXPECT_NEAR(look.goals[0].d, gap, 1e-4);
    EXPECT_EQ(look.in_touch, 0U);
    EXPECT_NE(look.goals[0].where.find("world 3, "), std::string::npos) << look.goals[0].where;
    EXPECT_NE(look.goals[0].where.find(" and ball"), std::string::npos) << look.goals[0].where;
  }
  World several = world(3, 0.04);  // of several goals the one nearest to an object counts
  several.further.assign(1, several.goal);
  Isometry X_WG = at_witness();
  X_WG.translation() += 0.03 * (several.objects[0].X_WO.translation() - X_WG.translation()).normalized();
  set_pose(several.further[0], X_WG.translation(), several.goal.file_rotation);
  run::WorldLook of_several;
  run::look_at(several, model_, of_several);
  ASSERT_EQ(of_several.goals.size(), 1U);
  EXPECT_NEAR(of_several.goals[0].d, 0.01, 2e-3);
  World moving = world(3, 0.005);
  Vector6 twist = Vector6::Zero();
  twist[4] = 0.2;
  moving.objects[0].motion = LinearMotion{twist};
  run::WorldLook look;
  run::look_at(moving, model_, look);
  EXPECT_EQ(look.goals.at(0).d, kInfinity) << "what moves is not there any more";
}

TEST_F(WorldLooks, GoalsNearerThanWhatIsKeptAreCounted) {
  const std::vector<std::string> texts =
      doubts(suite({world(0, 0.2), world(1, 0.01), world(2, 0.004)}, "{position: 0.02, orientation: 0.05}"));
  EXPECT_EQ(mention(texts, "controller neo: at the goal of 2 of 3 worlds"), 1) << ::testing::PrintToString(texts);
  EXPECT_EQ(mention(texts, "(nearest: 4.0 mm in world 2, "), static_cast<long>(texts.size()))
      << ::testing::PrintToString(texts);
  EXPECT_EQ(mention(texts, "controller moma"), 0) << "it comes as near as the goal needs";
  EXPECT_TRUE(doubts(suite({world(0, 0.2), world(1, 0.1)}, "{position: 0.02, orientation: 0.05}")).empty());
}

TEST_F(WorldLooks, GoalsWithLessRoomThanTheErrorsOfWhatIsMeasuredAreCounted) {
  const std::vector<World> worlds = {world(0, 0.2), world(1, 0.006), world(2, 0.004)};
  const auto texts = [&](const std::string& bias) {
    return doubts(suite(worlds, "{position: 0.02, orientation: 0.05}",
                        "disturbances: {objects: {bias: {position: " + bias + "}, noise: {position: 0.003}}}\n"));
  };
  EXPECT_EQ(mention(texts("0.004"), "errors of 5.0 mm"), 1) << ::testing::PrintToString(texts("0.004"));
  EXPECT_EQ(
      mention(texts("0.004"), "at the goal of 1 of 3 worlds the tool has less room (nearest: 4.0 mm in world 2, "), 1)
      << ::testing::PrintToString(texts("0.004"));
  EXPECT_EQ(mention(texts("0.01"), "at the goal of 2 of 3 worlds the tool has less room"), 1);
  EXPECT_EQ(mention(texts("0"), "matter of chance"), 0);
}

TEST_F(WorldLooks, GoalsInTouchAreCountedForThemselves) {
  const std::vector<std::string> texts =
      doubts(suite({world(0, 0.2), world(1, 0.01), world(2, -0.004)}, "{position: 0.02, orientation: 0.05}"));
  EXPECT_EQ(mention(texts, "at the goal of 1 of 3 worlds the tool touches an object"), 1)
      << ::testing::PrintToString(texts);
  EXPECT_EQ(mention(texts, "deepest: 4.0 mm in world 2, "), 1) << ::testing::PrintToString(texts);
  EXPECT_EQ(mention(texts, "controller neo: at the goal of 1 of 3 worlds"), 1) << ::testing::PrintToString(texts);
}

TEST_F(WorldLooks, StartsInTouchAreCounted) {
  const std::vector<std::string> texts =
      doubts(suite({world(0, 0.2), touching(1), touching(2)}, "{position: 0.02, orientation: 0.05}"));
  ASSERT_EQ(texts.size(), 1U);
  EXPECT_NE(texts[0].find("2 of 3 worlds start in contact"), std::string::npos) << texts[0];
  EXPECT_NE(texts[0].find("first: world 1, "), std::string::npos) << texts[0];
}

// A held object touches at start and goal, where the hand alone does not; it is no obstacle of its own.
TEST_F(WorldLooks, WhatIsHeldCountsAsTheHand) {
  World holds = world(0, 0.2);
  Kinematics kinematics(model_);
  kinematics.update(holds.start.base, holds.start.q);
  WorldObject rod;
  rod.name = "rod";
  rod.shape = {ShapeKind::kCylinder, Vector3(0.01, 0.1, 0.0), nullptr};
  set_pose(rod, kinematics.X_WE() * Vector3(0.0, 0.0, 0.05), Eigen::Quaterniond(kinematics.X_WE().linear()));
  holds.objects.push_back(rod);
  holds.held = Held{"rod", {}};
  run::WorldLook look, without;
  run::look_at(holds, model_, look);
  EXPECT_EQ(look.in_touch, 0U);
  EXPECT_LT(look.goals.at(0).d, 0.15);
  EXPECT_NE(look.goals[0].where.find("carried and ball"), std::string::npos) << look.goals[0].where;
  holds.objects.push_back(rod);
  holds.objects.back().name = "twin";
  holds.objects.back().X_WO.translation().x() += 0.01;
  run::look_at(holds, model_, look);
  EXPECT_EQ(look.in_touch, 1U);
  EXPECT_NE(look.first_touch.find("twin"), std::string::npos) << look.first_touch;
}

}  // namespace
}  // namespace moma
