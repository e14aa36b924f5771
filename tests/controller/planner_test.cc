// Inverse kinematics and whole plans against forward kinematics and coal's distances; the same plan however its work
// is spread; no memory taken.
#include "controller/plan/planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/controller/plan_scenes.h"
#include "tests/support/no_alloc.h"

namespace moma::test {
namespace {

class PlannerOf : public testing::TestWithParam<std::string> {
 protected:
  PlannerOf() : model(load_model(GetParam())), params(plan_params(*model)), planner(model, params) {}

  std::shared_ptr<const RobotModel> model;
  ControllerParams params;
  Planner planner;
};

INSTANTIATE_TEST_SUITE_P(Robots, PlannerOf, testing::ValuesIn(plan_robots()),
                         [](const auto& param) { return test_name(param.param); });

TEST_P(PlannerOf, GoalConfigurationsReachTheGoalAndAreFree) {
  Kinematics kinematics(model), start(model);
  int goals = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Scene scene = make_scene(model, seed, 15);
    plan_whole(planner, scene, seed);
    for (const GoalConfiguration& goal : planner.goals()) {
      ++goals;
      kinematics.update(goal.c.head<3>(), goal.c.tail(model->num_joints()));
      EXPECT_LT((kinematics.X_WE().translation() - scene.X_WG.translation()).norm(), 1e-3);
      const Eigen::AngleAxisd turn(kinematics.X_WE().linear().transpose() * scene.X_WG.linear());
      EXPECT_LT(std::abs(turn.angle()), 2e-3);
      EXPECT_GE(object_clearance(*model, kinematics, scene), params.plan.clearance - 1e-6);
      // Some pairs are always nearer than that; then as near as at the start is near enough.
      start.update(scene.start.head<3>(), scene.start.tail(model->num_joints()));
      EXPECT_GE(own_clearance(*model, kinematics),
                std::min(params.plan.self, own_clearance(*model, start) - 0.003) - 1e-6);
      if (!model->mobile()) {
        EXPECT_EQ(goal.c.head<3>().norm(), 0.0);
      }
    }
    for (std::size_t i = 1; i < planner.goals().size(); ++i)
      EXPECT_LE(planner.goals()[i - 1].cost, planner.goals()[i].cost);
  }
  EXPECT_GT(goals, 12) << "too few to say anything";
}

// Started from where links are nearer to each other than their rows' stop, or joints turned further than once.
TEST(Planner, GoalsAreWhereRowsAndJointsLetTheRobotGo) {
  const auto model = load_model("configs/robots/lift_ur5.yaml");
  ControllerParams params = plan_params(*model);
  params.collision.self.stop = 0.04;
  params.plan.self = 0.05;
  Planner planner(model, params);
  Kinematics kinematics(model);
  constexpr double kPi = std::numbers::pi;
  int goals = 0, unwound = 0, near = 0, low = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Scene scene = make_scene(model, seed, 8);
    scene.start[4] = seed % 2 == 0 ? 5.9 : -5.9;  // its shoulder, of +-2 pi
    double at_start = 1.0;
    for (double elbow = 2.0; at_start > 0.01; elbow += 0.002) {  // folds the arm, some of them until it nearly touches
      scene.start[6] = elbow;
      kinematics.update(scene.start.head<3>(), scene.start.tail(model->num_joints()));
      at_start = own_clearance(*model, kinematics);
      if (seed % 3 != 0) break;
    }
    ASSERT_GT(at_start, 0.005);
    near += at_start < 0.01 ? 1 : 0;
    plan_whole(planner, scene, seed);
    for (const GoalConfiguration& goal : planner.goals()) {
      ++goals;
      kinematics.update(goal.c.head<3>(), goal.c.tail(model->num_joints()));
      EXPECT_LT((kinematics.X_WE().translation() - scene.X_WG.translation()).norm(), 1e-3);
      EXPECT_GT(own_clearance(*model, kinematics), params.collision.self.stop) << "seed " << seed << ", " << at_start;
      for (int i = 4; i < 3 + model->num_joints(); ++i) {
        EXPECT_LE(std::abs(goal.c[i]), 2.0 * kPi);
        EXPECT_LE(std::abs(goal.c[i] - scene.start[i]), 2.0 * kPi) << "seed " << seed << ", joint " << i;
      }
      unwound += std::abs(goal.c[4] - scene.start[4]) > kPi ? 0 : 1;
      low += goal.c[3] < 0.1 || goal.c[3] > 0.3 ? 1 : 0;
    }
  }
  EXPECT_GT(goals, 170) << "those a turn away are lost";
  EXPECT_GT(near, 2);
  EXPECT_GT(unwound, goals / 4);
  EXPECT_GT(low, 5) << "the lift's whole range is of use";
}

TEST_P(PlannerOf, PathsLeadToTheGoalAndKeepClear) {
  Kinematics kinematics(model);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = make_scene(model, seed, 20);
    if (!plan_whole(planner, scene, seed)) continue;
    ++found;
    const Path& path = planner.path();
    EXPECT_GT(path.count, 0);
    WholeConfiguration c;
    path.at(0.0, c);
    EXPECT_EQ((c - scene.start).norm(), 0.0);
    double least = 1e9, own = 1e9;
    for (double t = 0.0; t < path.duration + 0.01; t += 0.01) {
      path.at(t, c);
      kinematics.update(c.head<3>(), c.tail(model->num_joints()));
      least = std::min(least, object_clearance(*model, kinematics, scene));
      own = std::min(own, own_clearance(*model, kinematics));
    }
    EXPECT_LT((kinematics.X_WE().translation() - scene.X_WG.translation()).norm(), 2e-3);
    // Half the clearance where motions overlap, less what may happen between two checks.
    EXPECT_GT(least, 0.5 * path.clearance - 0.02) << "seed " << seed << ", laid with " << path.clearance;
    EXPECT_GT(least, 0.0) << "seed " << seed;
    EXPECT_GT(own, 0.0) << "seed " << seed;
  }
  EXPECT_GE(found, !model->mobile() ? 5 : 9);
}

TEST_P(PlannerOf, TheSamePlanHoweverItIsSpread) {
  Planner other(model, params);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Scene scene = make_scene(model, seed, 20);
    plan_whole(planner, scene, seed);
    for (const long budget : {50L, 700L, 5000L}) {
      other.set_objects(scene.shapes);  // which forgets the plan before
      other.begin(scene.start, scene.X_WG, scene.states, seed);
      long steps = 0, debt = 0;
      do {
        long left = budget - debt;
        ++steps;
        if (!other.advance(left)) break;
        debt = std::max(0L, -left);
        EXPECT_LE(debt, 3 * (FreeSpace::kMostParts + 1)) << "one piece of work is more than three edges";
      } while (steps < 1000000);
      ASSERT_EQ(other.stage(), planner.stage()) << "seed " << seed << " at " << budget;
      EXPECT_EQ(other.counts().checks, planner.counts().checks);
      EXPECT_GE(steps, planner.counts().checks / (budget + FreeSpace::kMostParts));
      if (!planner.found()) continue;
      ASSERT_EQ(other.path().count, planner.path().count);
      EXPECT_EQ(other.path().duration, planner.path().duration);
      for (int k = 0; k < planner.path().count; ++k) {
        const PathPart &a = planner.path().motions[static_cast<std::size_t>(k)],
                       &b = other.path().motions[static_cast<std::size_t>(k)];
        EXPECT_EQ(a.start, b.start);
        EXPECT_EQ(a.time, b.time);
        EXPECT_EQ((a.change - b.change).norm(), 0.0);
      }
    }
  }
}

TEST_P(PlannerOf, TakesNoMemory) {
  if (!NoAlloc::works()) GTEST_SKIP() << "sanitizers bring a malloc of their own";
  const Scene scene = make_scene(model, 3, 20);
  planner.set_objects(scene.shapes);
  const NoAlloc guard;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    planner.begin(scene.start, scene.X_WG, scene.states, seed);
    long budget = 1L << 40;
    planner.advance(budget);
  }
  EXPECT_EQ(guard.count(), 0);
}

TEST_P(PlannerOf, SaysWhereThereIsNoWay) {
  Scene scene = make_scene(model, 1, 0);
  // A box around the goal.
  scene.shapes = {{"block", make_box(0.3, 0.3, 0.3)}};
  scene.states.resize(1);
  scene.states[0].X_WO.translation() = scene.X_WG.translation();
  EXPECT_FALSE(plan_whole(planner, scene, 1));
  EXPECT_EQ(planner.stage(), PlanStage::kFailed);
  EXPECT_EQ(planner.counts().goals, 0);
  EXPECT_EQ(planner.counts().ik_tries, 2 * params.plan.ik_tries);
  // What moves or is not seen is in nobody's way here.
  scene.states[0].V_WO_W[3] = 0.2;
  EXPECT_TRUE(plan_whole(planner, scene, 1));
  scene.states[0].V_WO_W[3] = 0.0;
  scene.states[0].visible = false;
  EXPECT_TRUE(plan_whole(planner, scene, 1));
}

// Straight there is a wall: round it is the only way for a base.
TEST_P(PlannerOf, GoesRoundAWall) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  Scene scene = make_scene(model, 2, 0);
  scene.X_WG.translation().head<2>() << 2.6, 0.0;
  scene.shapes = {{"wall", make_box(0.2, 3.0, 3.0)}};
  scene.states.resize(1);
  scene.states[0].X_WO.translation() << 1.3, 0.0, 1.5;
  ASSERT_TRUE(plan_whole(planner, scene, 1));
  WholeConfiguration c;
  double beside = 0.0;
  for (double t = 0.0; t < planner.path().duration; t += 0.05) {
    planner.path().at(t, c);
    if (std::abs(c[0] - 1.3) < 0.1) beside = std::max(beside, std::abs(c[1]));
  }
  EXPECT_GT(beside, 1.5);
}

}  // namespace
}  // namespace moma::test
