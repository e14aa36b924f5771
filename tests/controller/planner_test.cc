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
    for (int index = 0; index < kTries && !solved; ++index) solved = ik.find(space, X_WG, start, {}, index, draws, c);
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
        EXPECT_EQ(a.time, b.time);
        EXPECT_EQ((a.change - b.change).norm(), 0.0);
      }
    }
  }
}

// A shelf in front of a Panda, open to it, with the hand's goal inside, and a plate before it that leaves a slot.
Scene inside_a_shelf(const std::shared_ptr<const RobotModel>& model, std::uint64_t seed) {
  Scene scene = make_scene(model, seed, 0);
  std::mt19937_64 engine(seed);
  scene.start[3] = 1.4;  // the arm, beside it
  const Vector3 at(0.6, uniform_in(engine, -0.1, 0.1), uniform_in(engine, 0.45, 0.6));
  scene.X_WG.linear() = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3::UnitY()).toRotationMatrix();
  scene.X_WG.translation() = at;
  const auto plate = [&](const Vector3& size, const Vector3& from_goal) {
    scene.shapes.push_back({"plate" + std::to_string(scene.shapes.size()), make_box(size.x(), size.y(), size.z())});
    scene.states.emplace_back();
    scene.states.back().X_WO.translation() = at + from_goal;
  };
  plate({0.5, 0.6, 0.02}, {0.05, 0.0, -0.17});
  plate({0.5, 0.6, 0.02}, {0.05, 0.0, 0.17});
  plate({0.5, 0.02, 0.36}, {0.05, -0.3, 0.0});
  plate({0.5, 0.02, 0.36}, {0.05, 0.3, 0.0});
  plate({0.02, 0.6, 0.36}, {0.3, 0.0, 0.0});
  return scene;
}

// Of many goal configurations, by trees that go as far as they can: before there were 3 to 19, and 5858 checks.
TEST(Planner, NarrowPlacesTakeFewChecks) {
  const auto model = load_model("configs/robots/panda.yaml");
  ControllerParams params = plan_params(*model);
  params.plan.roomy = params.plan.clearance;
  params.plan.checks = 200000;
  params.plan.runs = 1;
  Planner planner(model, params);
  std::vector<long> checks;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    if (!plan_whole(planner, inside_a_shelf(model, seed), seed)) continue;
    checks.push_back(planner.counts().checks);
    EXPECT_GE(planner.counts().goals, 20) << "seed " << seed;
  }
  ASSERT_GE(checks.size(), 14u);
  std::sort(checks.begin(), checks.end());
  EXPECT_LT(checks[checks.size() / 2], 4500);
}

// Adds two boxes with these edges, one on either side of the goal.
void add_on_both_sides(Scene& scene, const std::string& name, const Vector3& edges, const Vector3& offset) {
  for (const double side : {-1.0, 1.0}) {
    scene.shapes.push_back({name + (side < 0.0 ? " 1" : " 2"), make_box(edges.x(), edges.y(), edges.z())});
    scene.states.emplace_back();
    scene.states.back().X_WO.translation() = scene.X_WG.translation() + side * offset;
  }
}

// The goal has the hand close to two plates.
Scene between_plates(const std::shared_ptr<const RobotModel>& model, std::uint64_t seed) {
  Scene scene = inside_a_shelf(model, seed);
  add_on_both_sides(scene, "plate", {0.3, 0.4, 0.01}, {0.0, 0.0, 0.065});
  return scene;
}

ControllerParams close_params(const RobotModel& model, int checks) {
  ControllerParams params = plan_params(model);
  params.collision.at_goal.enabled = true;
  params.plan.checks = checks;
  params.plan.runs = 1;
  return params;
}

// Trees of joint steps alone need 10961 checks in the median.
TEST(Planner, FromBetweenPlatesTheHandMovesStraight) {
  const auto model = load_model("configs/robots/panda.yaml");
  Planner planner(model, close_params(*model, 200000));
  std::vector<long> checks;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    const Scene scene = between_plates(model, seed);
    const bool found = plan_whole(planner, scene, seed);
    EXPECT_TRUE(planner.close_goal()) << "seed " << seed;
    if (found) checks.push_back(planner.counts().checks);
  }
  ASSERT_GE(checks.size(), 14u);
  std::sort(checks.begin(), checks.end());
  EXPECT_LT(checks[checks.size() / 2], 6000);
}

// From between the same plates and two walls, by a base that drives: base and arm also move apart. Where they only move
// together, three quarters of the plans need up to 13644 checks.
TEST(Planner, InNarrowPlacesBaseAndArmMoveApart) {
  const auto model = load_model("configs/robots/frankie.yaml");
  Planner planner(model, close_params(*model, 2000));
  std::vector<long> checks;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    Scene scene = between_plates(model, seed);
    add_on_both_sides(scene, "wall", {0.5, 0.02, 0.36}, {0.0, 0.16, 0.0});
    scene.start.head<3>() << -0.6, 0.0, 0.0;
    bool found = plan_whole(planner, scene, seed);
    EXPECT_TRUE(planner.close_goal()) << "seed " << seed;
    long sum = planner.counts().checks;
    for (int k = 0; !found && k < 6; ++k) {
      planner.begin(scene.start, scene.X_WG, scene.states, seed);
      long budget = 1L << 40;
      planner.advance(budget);
      found = planner.found();
      sum += planner.counts().checks;
    }
    EXPECT_TRUE(found) << "seed " << seed;
    checks.push_back(sum);
  }
  std::sort(checks.begin(), checks.end());
  EXPECT_LT(checks[11], 12000);
}

// A ball comes along the hand until that is close to it at its goal.
void close_in(Planner& planner, Scene& scene) {
  scene.shapes.push_back({"ball", make_sphere(0.03)});
  scene.states.emplace_back();
  for (double away = 0.3; away > 0.0; away -= 0.01) {
    scene.states.back().X_WO.translation() = scene.X_WG * Vector3(0.0, 0.0, away);
    planner.set_objects(scene.shapes);
    planner.begin(scene.start, scene.X_WG, scene.states, 1);
    if (planner.close_goal()) return;
  }
}

// A failed plan keeps what it found when a robot whose joints wind has moved a little.
TEST(Planner, GoesOnAfterTheStartHasMoved) {
  const auto model = load_model("configs/robots/ur5.yaml");
  ControllerParams params = plan_params(*model);
  params.collision.at_goal.enabled = true;
  params.plan.checks = 1;
  Planner planner(model, params);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Scene scene = make_scene(model, seed, 0);
    close_in(planner, scene);
    ASSERT_TRUE(planner.close_goal());
    ASSERT_FALSE(plan_whole(planner, scene, seed));
    ASSERT_GE(planner.counts().goals, params.plan.ik_enough) << "seed " << seed;
    const auto again = [&](double turn) {
      for (int i = 3; i < 9; ++i) scene.start[i] += i % 2 == 0 ? turn : -turn;
      planner.begin(scene.start, scene.X_WG, scene.states, seed);
      long budget = 1L << 40;
      planner.advance(budget);
      return planner.counts().ik_tries;
    };
    EXPECT_EQ(again(0.05), 0) << "seed " << seed;
    EXPECT_EQ(again(-0.1), 0) << "seed " << seed;
    EXPECT_GT(again(1.8), 0) << "seed " << seed << ": more than a quarter of a turn";
    for (const GoalConfiguration& goal : planner.goals())
      for (int i = 3; i < 9; ++i) EXPECT_LE(std::abs(goal.c[i] - scene.start[i]), kFullTurn);
  }
}

// Measurements of a world at rest differ by their noise, however long they are averaged.
TEST(Planner, GoesOnAmongMeasurementsThatDiffer) {
  const auto model = load_model("configs/robots/panda.yaml");
  ControllerParams params = close_params(*model, 1);
  params.plan.search.same = 0.005;
  params.plan.search.same_goal = 0.002;
  Planner planner(model, params);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Scene scene = make_scene(model, seed, 0);
    close_in(planner, scene);
    ASSERT_TRUE(planner.close_goal());
    ASSERT_FALSE(plan_whole(planner, scene, seed));
    ASSERT_GE(planner.counts().goals, params.plan.ik_enough) << "seed " << seed;
    const auto tries_after = [&](double object, double goal) {
      scene.states.back().X_WO.translation().y() += object;
      scene.X_WG.translation().y() += goal;
      planner.begin(scene.start, scene.X_WG, scene.states, seed);
      long budget = 1L << 40;
      planner.advance(budget);
      return planner.counts().ik_tries;
    };
    const SearchParams& search = params.plan.search;
    EXPECT_EQ(tries_after(0.9 * search.same, 0.0), 0) << "seed " << seed;
    EXPECT_EQ(tries_after(0.0, 0.9 * search.same_goal), 0) << "seed " << seed;
    EXPECT_GT(tries_after(1.1 * search.same, 0.0), 0) << "seed " << seed;
    EXPECT_GT(tries_after(0.0, 1.1 * search.same_goal), 0) << "seed " << seed;
  }
}

// Trees end short of what blocks them. A corner at the least distance goes up to an object for nothing.
TEST(Planner, CornersKeepAwayFromWhatBlocksATree) {
  const auto model = load_model("configs/robots/panda.yaml");
  Kinematics kinematics(model);
  const auto touching = [&](double back) {
    ControllerParams params = close_params(*model, 200000);
    params.plan.shortcuts = 0;
    params.plan.search.back = back;
    Planner planner(model, params);
    int near = 0;
    for (std::uint64_t seed = 1; seed <= 15; ++seed) {
      const Scene scene = between_plates(model, seed);
      if (!plan_whole(planner, scene, seed)) continue;
      for (const Edge& edge : planner.edges().all().subspan(1)) {
        kinematics.update(edge.a.head<3>(), edge.a.tail(model->num_joints()));
        if (object_clearance(*model, kinematics, scene) < planner.path().clearance + 0.005) ++near;
      }
    }
    return near;
  };
  const int short_of = touching(0.7), all_the_way = touching(1.0);
  EXPECT_LT(short_of, all_the_way) << short_of << " corners against " << all_the_way;
}

// An object is measured where the hand would be, so that nothing holds the goal itself.
TEST(Planner, AGoalThatNothingHoldsIsMissedWithinItsTolerances) {
  const auto model = load_model("configs/robots/panda.yaml");
  ControllerParams params = close_params(*model, 20000);
  params.escape.position = 0.01;
  params.escape.orientation = 0.05;
  Planner exact(model, params);
  params.plan.search.off_goal = 0.4;
  Planner near(model, params);
  const MotionLimits limits(*model, params);
  GoalClearance hand(*model);
  FreeSpace space(model, limits);
  Kinematics kinematics(model);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Scene scene = make_scene(model, seed, 0);
    scene.shapes.push_back({"ball", make_sphere(0.03)});
    scene.states.emplace_back();
    space.set_objects(scene.shapes);
    hand.allocate(1);
    for (double away = 0.1; away > 0.0; away -= 0.0005) {
      scene.states.back().X_WO.translation() = scene.X_WG * Vector3(0.0, 0.0, away);
      space.set_states(scene.states);
      if (space.least_at_goal(hand, scene.start, scene.X_WG, 0.1) < 0.001) break;
    }
    const auto finds = [&](Planner& planner) {
      bool any = plan_whole(planner, scene, seed);
      for (int k = 0; !any && k < 3; ++k) {
        planner.begin(scene.start, scene.X_WG, scene.states, seed);
        long budget = 1L << 40;
        planner.advance(budget);
        any = planner.found();
      }
      return any;
    };
    EXPECT_FALSE(finds(exact)) << "seed " << seed;
    if (!finds(near)) continue;
    ++found;
    WholeConfiguration c;
    near.path().at(near.path().duration, c);
    kinematics.update(c.head<3>(), c.tail(model->num_joints()));
    EXPECT_LT((kinematics.X_WE().translation() - scene.X_WG.translation()).norm(), 0.4 * 0.01 + 1e-3);
    EXPECT_GT(object_clearance(*model, kinematics, scene), 0.0015);
  }
  EXPECT_GE(found, 4);
}

// What a path needs of time is worth more than a quicker path, from some moment on.
TEST(Planner, InAHurryTheBestSoFarCounts) {
  const auto model = load_model("configs/robots/panda.yaml");
  Planner planner(model, plan_params(*model));
  int hurried = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Scene scene = inside_a_shelf(model, seed);
    if (!plan_whole(planner, scene, seed)) continue;
    const PlanCounts whole = planner.counts();
    planner.set_objects(scene.shapes);
    planner.begin(scene.start, scene.X_WG, scene.states, seed);
    long budget = 0;
    do {
      planner.hurry();
      budget = 50;
    } while (planner.advance(budget));
    ASSERT_TRUE(planner.found()) << "seed " << seed;
    EXPECT_LE(planner.counts().checks, whole.checks);
    hurried += planner.counts().runs < whole.runs ? 1 : 0;
    Kinematics kinematics(model);
    WholeConfiguration c;
    planner.path().at(planner.path().duration, c);
    kinematics.update(c.head<3>(), c.tail(model->num_joints()));
    EXPECT_LT((kinematics.X_WE().translation() - scene.X_WG.translation()).norm(), 2e-3);
  }
  EXPECT_GE(hurried, 3);
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
