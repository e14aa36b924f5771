// Inverse kinematics and whole plans against forward kinematics and coal's distances; the same plan however its work
// is spread; no memory taken.
#include "controller/plan/planner.h"

#include <gtest/gtest.h>

#include <algorithm>
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
        EXPECT_LE(std::abs(goal.c[i]), 2.0 * std::numbers::pi);
        EXPECT_LE(std::abs(goal.c[i] - scene.start[i]), 2.0 * std::numbers::pi) << "seed " << seed << ", joint " << i;
      }
      unwound += std::abs(goal.c[4] - scene.start[4]) > std::numbers::pi ? 0 : 1;
      low += goal.c[3] < 0.1 || goal.c[3] > 0.3 ? 1 : 0;
    }
  }
  EXPECT_GT(goals, 170) << "those a turn away are lost";
  EXPECT_GT(near, 2);
  EXPECT_GT(unwound, goals / 4);
  EXPECT_GT(low, 5) << "the lift's whole range is of use";
}

// A UR5 whose joints turn once, as most files have it.
std::shared_ptr<RobotModel> ur5_of_one_turn() {
  auto model = std::make_shared<RobotModel>(*load_model("configs/robots/ur5.yaml"));
  for (ControlledJoint& joint : model->joints) {
    joint.lower = -std::numbers::pi;
    joint.upper = std::numbers::pi;
  }
  return model;
}

// Iterations that come to a limit of -pi or pi go on from the other one: where joints stay there 54 of 100 are found.
TEST(WholeBodyIk, JointsOfAWholeTurnGoOnFromTheirOtherLimit) {
  const auto model = ur5_of_one_turn();
  const MotionLimits limits(*model, plan_params(*model));
  FreeSpace space(model, limits);
  WholeBodyIk ik(model, {}, limits);
  ik.keep_room(0.0);
  std::mt19937_64 engine(1);
  Kinematics kinematics(model);
  WholeConfiguration start = WholeConfiguration::Zero(9), c;
  start.tail(6) = model->ready;
  space.set_clearances({-1.0, -1.0, -1.0}, start, 0.0);
  constexpr int kGoals = 100, kTries = 4;
  int found = 0;
  for (int k = 0; k < kGoals; ++k) {
    VectorX q(6);
    for (int i = 0; i < 6; ++i) q[i] = uniform_in(engine, -3.0, 3.0);
    q[5] = (k % 2 == 0 ? 1.0 : -1.0) * uniform_in(engine, std::numbers::pi - 0.05, std::numbers::pi);
    kinematics.update(Vector3::Zero(), q);
    const Isometry X_WG = kinematics.X_WE();
    CountedDraws draws{static_cast<std::uint64_t>(k), 0};
    bool solved = false;
    for (int index = 0; index < kTries && !solved; ++index)
      solved = ik.find(space, X_WG, start, {}, index, draws, false, c);
    found += solved ? 1 : 0;
    if (!solved) continue;
    EXPECT_TRUE(space.free(c)) << k;
    kinematics.update(Vector3::Zero(), c.tail(6));
    EXPECT_LT((kinematics.X_WE().translation() - X_WG.translation()).norm(), 1e-3);
  }
  EXPECT_GE(found, 80);
}

// Its wrist on its limits at the only configuration that reaches the goal.
TEST(Planner, AGoalOnJointLimitsHasAPath) {
  const auto model = ur5_of_one_turn();
  ControllerParams params = plan_params(*model);
  params.collision.at_goal.enabled = true;
  std::mt19937_64 engine(2);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    VectorX q(6);
    q << uniform_in(engine, -1.0, 1.0), uniform_in(engine, -1.5, -1.0), uniform_in(engine, 1.0, 1.5), -1.2, -1.5, 0.5;
    const auto bounded = std::make_shared<RobotModel>(*model);
    for (int i = 0; i < 6; ++i) {
      ControlledJoint& joint = bounded->joints[static_cast<std::size_t>(i)];
      joint.lower = q[i] - 1.0;
      joint.upper = i < 3 ? q[i] + 1.0 : q[i];
      bounded->ready[i] = q[i] - 0.5;
    }
    Planner planner(bounded, params);
    Scene scene = make_scene(bounded, seed, 0);
    Kinematics kinematics(bounded);
    kinematics.update(Vector3::Zero(), q);
    scene.X_WG = kinematics.X_WE();
    if (!plan_whole(planner, scene, seed)) continue;
    ++found;
    WholeConfiguration end;
    planner.path().at(planner.path().duration, end);
    kinematics.update(Vector3::Zero(), end.tail(6));
    EXPECT_LT((kinematics.X_WE().translation() - scene.X_WG.translation()).norm(), 2e-3);
  }
  EXPECT_EQ(found, 5);
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
        EXPECT_EQ(a.motion.time, b.motion.time);
        EXPECT_EQ((a.change - b.change).norm(), 0.0);
      }
    }
  }
}

// A step of a tree that is blocked goes as far as the last configuration that was looked at and is free.
TEST_P(PlannerOf, EdgesAreFreeUpToTheirFreePart) {
  const MotionLimits limits(*model, params);
  FreeSpace space(model, limits);
  const Scene scene = make_scene(model, 5, 25);
  space.set_objects(scene.shapes);
  space.set_states(scene.states);
  space.set_clearances({0.01, 0.0, -1.0}, scene.start);
  CountedDraws draws{3, 0};
  constexpr double kStep = 0.02;
  int blocked = 0, free = 0;
  Edge edge;
  for (int k = 0; k < 60; ++k) {
    WholeConfiguration to = scene.start;
    if (model->mobile()) to.head<2>() += 0.5 * Vector2(draws.uniform(-1.0, 1.0), draws.uniform(-1.0, 1.0));
    for (int i = 3; i < to.size(); ++i) to[i] += limits.part[i - 3] * draws.uniform(-0.7, 0.7);
    make_edge(limits, scene.start, to, edge);
    const double part = space.free_part(edge, kStep);
    const int looks = 200;
    int first = looks + 1;  // that is not free
    for (int l = 0; l <= looks && first > looks; ++l) {
      WholeConfiguration c;
      edge_point(limits, edge, static_cast<double>(l) / looks, c);
      if (!space.free(c)) first = l;
    }
    (part < 1.0 ? blocked : free) += 1;
    if (first > looks) {
      EXPECT_EQ(part, 1.0) << k;
    }
    // Between two that it looked at it may be blocked, or be free for less than it looked further.
    const double between = kStep / longest_way(limits, edge) + 1.0 / FreeSpace::kMostParts;
    EXPECT_LE(part, static_cast<double>(first) / looks + between) << k;
    EXPECT_GE(part, std::min(1.0, static_cast<double>(first - 1) / looks - between)) << k;
    EXPECT_EQ(part == 1.0, space.free(edge, kStep)) << k;
  }
  EXPECT_GT(blocked, 5);
  EXPECT_GT(free, 5);
}

TEST_P(PlannerOf, TakesNoMemory) {
  if (!NoAlloc::works()) GTEST_SKIP() << "sanitizers bring a malloc of their own";
  const Scene scene = make_scene(model, 3, 20);
  planner.set_objects(scene.shapes);
  const NoAlloc guard;
  for (std::uint64_t seed = 0; seed < 3; ++seed) plan_again(planner, scene, seed);
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

// A goal straight behind a wall: round it is the only way for a base.
Scene behind_a_wall(const std::shared_ptr<const RobotModel>& model) {
  Scene scene = make_scene(model, 2, 0);
  scene.X_WG.translation().head<2>() << 2.6, 0.0;
  scene.shapes = {{"wall", make_box(0.2, 3.0, 3.0)}};
  scene.states.resize(1);
  scene.states[0].X_WO.translation() << 1.3, 0.0, 1.5;
  return scene;
}

TEST_P(PlannerOf, GoesRoundAWall) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  const Scene scene = behind_a_wall(model);
  ASSERT_TRUE(plan_whole(planner, scene, 1));
  WholeConfiguration c;
  double beside = 0.0;
  for (double t = 0.0; t < planner.path().duration; t += 0.05) {
    planner.path().at(t, c);
    if (std::abs(c[0] - 1.3) < 0.1) beside = std::max(beside, std::abs(c[1]));
  }
  EXPECT_GT(beside, 1.5);
}

// The path includes the braking, the time that it may take does not.
TEST_P(PlannerOf, BrakingIsNoPartOfTheTimeThatCounts) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  const Scene scene = behind_a_wall(model);
  Braking braking{scene.start, 0.4};
  braking.from[0] -= 0.1;
  const auto duration = [&](double within) {
    planner.set_objects(scene.shapes);
    planner.begin(scene.start, scene.X_WG, scene.states, 1, within, braking);
    long budget = 1L << 40;
    planner.advance(budget);
    return planner.found() ? planner.path().duration : kInfinity;
  };
  const double any = duration(kInfinity);
  ASSERT_LT(any, 30.0);
  EXPECT_EQ(duration(any - braking.time + 0.02), any);
  const double quicker = duration(any - braking.time - 0.02);
  EXPECT_TRUE(quicker < any || quicker == kInfinity) << quicker << " s";
}

// Where the nearest of the poses that a goal allows is blocked, others are found.
TEST(PlannerFree, DrawsWhatAGoalLeavesFree) {
  const auto model = load_model("configs/robots/panda.yaml");
  const ControllerParams params = plan_params(*model);
  Scene scene = make_scene(model, 3, 0);
  Kinematics kinematics(model);
  kinematics.update(Vector3::Zero(), model->ready);
  scene.X_WG = kinematics.X_WE();
  scene.X_WG.translation() += Vector3(0.1, 0.2, 0.0);
  scene.shapes = {{"ball", make_sphere(0.06)}};
  scene.states.resize(1);
  scene.states[0].X_WO.translation() = scene.X_WG.translation();
  const auto plan = [&](const FreeDirections& free) {
    Planner planner(model, params);
    planner.set_objects(scene.shapes);
    planner.begin(scene.start, scene.X_WG, scene.states, 1, kInfinity, {}, free);
    long budget = 1L << 40;
    planner.advance(budget);
    return std::pair(planner.found(), planner.found() ? planner.path() : Path{});
  };
  EXPECT_FALSE(plan({}).first);
  FreeDirections along{.free = Vector6::Zero(), .R_WG = scene.X_WG.linear()};
  along.free[4] = 1.0;  // the place along y
  FreeDirections turned = along;
  turned.free[2] = 1.0;  // and the turn about z
  for (const FreeDirections& free : {along, turned}) {
    const auto [found, path] = plan(free);
    ASSERT_TRUE(found);
    WholeConfiguration c;
    path.at(path.duration, c);
    kinematics.update(c.head<3>(), c.tail(model->num_joints()));
    const Vector6 error = pose_error(kinematics.X_WE(), nearest_pose(scene.X_WG, free.free, kinematics.X_WE()));
    EXPECT_LT(error.tail<3>().norm(), 1.1e-3) << "not a pose that the goal allows";
    EXPECT_LT(error.head<3>().norm(), 2.1e-3);
    EXPECT_GT(object_clearance(*model, kinematics, scene), 0.02);
  }
}

// An arm of six joints that stands has a few configurations at a pose, and tries find them again and again.
TEST(Planner, GoalConfigurationsDiffer) {
  const auto model = load_model("configs/robots/ur5.yaml");
  Planner planner(model, plan_params(*model));
  std::size_t found = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = make_scene(model, seed, 6);
    plan_whole(planner, scene, seed);
    const auto goals = planner.goals();
    found += goals.size();
    for (std::size_t i = 0; i < goals.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_GT(planner.limits().distance_squared(goals[i].c, goals[j].c), 0.12 * 0.12)
            << "seed " << seed << ": " << i << " and " << j;
  }
  EXPECT_GE(found, 20u);
}

// A metre of the base counts as it is; a joint by half of what it moves: a shoulder's turn more than a wrist's.
TEST(Planner, DistancesAreWaysOfTheRobot) {
  const auto model = load_model("configs/robots/frankie.yaml");
  const MotionLimits limits(*model, plan_params(*model));
  const WholeConfiguration a = WholeConfiguration::Zero(3 + model->num_joints());
  const auto distance = [&](int i, double by) {
    WholeConfiguration b = a;
    b[i] += by;
    return std::sqrt(limits.distance_squared(a, b));
  };
  EXPECT_NEAR(distance(0, 0.4), 0.4, 1e-12);
  EXPECT_NEAR(distance(2, 2 * std::numbers::pi), 0.0, 1e-12);
  for (int i = 0; i < model->num_joints(); ++i) EXPECT_NEAR(distance(3 + i, 0.2), 0.1 * limits.lever[i], 1e-12) << i;
  EXPECT_GT(distance(3, 1.0), 3.0 * distance(9, 1.0));
}

// Its search has no work, so that each plan fails.
TEST(Planner, AFailedPlanLooksForMoreGoals) {
  const auto model = load_model("configs/robots/panda.yaml");
  ControllerParams params = plan_params(*model);
  params.plan.ik_enough = 4;
  params.plan.checks = 1;
  Planner planner(model, params);
  const Scene scene = make_scene(model, 1, 6);
  planner.set_objects(scene.shapes);
  for (const std::size_t enough : {4u, 8u}) {
    EXPECT_FALSE(plan_again(planner, scene, 1));
    EXPECT_GE(planner.goals().size(), enough);
  }
}

}  // namespace
}  // namespace moma::test
