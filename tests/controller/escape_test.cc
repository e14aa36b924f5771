// Stagnation and detours, step by step on made-up situations.

#include "controller/task/escape.h"

#include <gtest/gtest.h>

#include "controller/task/servo.h"
#include "tests/controller/qp_robots.h"
#include "tests/support/control_period.h"

namespace moma {
namespace {

using namespace test;

ProximityPair object_pair(double d, const Vector3& n, int object = 0) {
  ProximityPair pair;
  pair.second = object;
  pair.distance.d = d;
  pair.distance.n_W = n.normalized();
  return pair;
}

// A robot that stands still, 1 m in front of a goal it does not get to unless told otherwise.
struct Scene {
  std::shared_ptr<const RobotModel> model;
  Kinematics kinematics;
  EscapeParams params;
  ServoParams servo;
  GoalState goal;
  std::vector<ProximityPair> pairs;
  Escape escape;
  Task task;

  explicit Scene(std::shared_ptr<const RobotModel> m = frankie(), const EscapeParams& e = on(), ServoParams s = {})
      : model(std::move(m)), kinematics(model), params(e), servo(s), escape(e, s, *model, kPeriod) {
    goal.X_WG = kinematics.X_WE();
    goal.X_WG.translation() += Vector3(1, 0, 0);
  }
  static EscapeParams on() {
    EscapeParams e;
    e.enabled = true;
    return e;
  }
  const EscapeState& step() {
    task = Task{};
    task.error = pose_error(kinematics.X_WE(), goal.X_WG);
    task.nu = servo_twist(servo, task.error, goal.V_WG_W);
    escape.update({kinematics, goal, pairs}, task);
    return escape.state();
  }
  // Steps until the n-th stagnation, at most `limit`; how many steps that took.
  int until_stagnation(int n, int limit = 1000) {
    int steps = 0;
    while (escape.state().stagnations < n && steps < limit) {
      step();
      ++steps;
    }
    return steps;
  }
  void approach(double metres) { goal.X_WG.translation().x() -= metres; }
};

int periods(double seconds) { return static_cast<int>(std::lround(seconds / kPeriod)); }

TEST(Stagnation, ComesAfterPatienceWithoutProgressAndNotBefore) {
  Scene scene;
  EXPECT_NEAR(scene.until_stagnation(1), periods(scene.params.patience) + 1, 1);
  EXPECT_TRUE(scene.escape.state().detour);
}

TEST(Stagnation, ProgressStartsTheClockAfresh) {
  Scene scene;
  scene.step();
  // The way shrinks by `progress` and a little every 0.9 of the patience.
  for (int leg = 0; leg < 20; ++leg) {
    for (int i = 0; i < periods(0.9 * scene.params.patience); ++i) scene.step();
    scene.approach(1.1 * scene.params.progress);
  }
  EXPECT_EQ(scene.escape.state().stagnations, 0);
  // Less than that does not count as progress.
  for (int leg = 0; leg < 2; ++leg) {
    for (int i = 0; i < periods(0.9 * scene.params.patience); ++i) scene.step();
    scene.approach(0.4 * scene.params.progress);
  }
  EXPECT_EQ(scene.escape.state().stagnations, 1);
}

TEST(Stagnation, NotAtTheGoal) {
  Scene scene;
  scene.goal.X_WG = scene.kinematics.X_WE();
  scene.goal.X_WG.translation().x() += 0.9 * scene.params.position;
  EXPECT_EQ(scene.until_stagnation(1, 500), 500);
  scene.goal.X_WG.translation().x() += 0.2 * scene.params.position;
  EXPECT_LT(scene.until_stagnation(1, 500), 100);
}

TEST(Stagnation, AFollowedGoalIsProgressAndOneThatComesToAnArm) {
  // The goal leaves at 0.3 m/s and the robot keeps its distance: V stands still, the robot does not.
  Scene follow;
  follow.goal.V_WG_W << 0, 0, 0, 0.3, 0, 0;
  EXPECT_EQ(follow.until_stagnation(1, 500), 500);
  // It leaves, and the robot is held: no excuse.
  Scene held;
  held.goal.V_WG_W << 0, 0, 0, 0.3, 0, 0;
  int steps = 0;
  for (; steps < 500 && held.escape.state().stagnations == 0; ++steps) {
    held.step();
    held.goal.X_WG.translation().x() += 0.3 * kPeriod;
  }
  EXPECT_NEAR(steps, periods(held.params.patience) + 1, 1);
  // It comes to a robot that stands: an arm may wait for it, a base is held.
  const auto stagnations = [](Scene come) {
    come.goal.V_WG_W << 0, 0, 0, -0.1, 0, 0;
    for (int i = 0; i < 200; ++i) {
      come.step();
      come.approach(0.1 * kPeriod);
    }
    return come.escape.state().stagnations;
  };
  EXPECT_EQ(stagnations(Scene(panda())), 0);
  EXPECT_GT(stagnations(Scene(frankie())), 0);
}

TEST(Stagnation, ANewGoalStartsEverythingAfresh) {
  Scene scene;
  scene.until_stagnation(2);
  scene.goal.X_WG.translation().y() += 1.5;
  const EscapeState& state = scene.step();
  EXPECT_EQ(state.stagnations, 0);
  EXPECT_FALSE(state.detour);
  EXPECT_EQ(state.side, 0);
  scene.until_stagnation(1);
  scene.goal.X_WG.linear() = Eigen::AngleAxisd(0.5, Vector3::UnitY()) * scene.goal.X_WG.linear();
  EXPECT_EQ(scene.step().stagnations, 0);
}

TEST(Stagnation, SetStateGoesOnWhereItWas) {
  Scene first;
  for (int i = 0; i < 75; ++i) first.step();
  Scene second;
  second.escape.set_state(first.escape.state());
  for (int i = 0; i < 400; ++i) {
    first.step();
    second.step();
    EXPECT_EQ(first.task.nu, second.task.nu) << i;
    EXPECT_EQ(first.escape.state().idle, second.escape.state().idle) << i;
    EXPECT_EQ(first.escape.state().target_W, second.escape.state().target_W) << i;
  }
  EXPECT_GT(first.escape.state().stagnations, 2);
}

TEST(Detour, SideWithMoreRoom) {
  const Vector3 e(1, 0, 0);
  // An obstacle to the left pushes right (n = -y), so the way out is to the right.
  EXPECT_EQ(free_side(std::vector{object_pair(0.05, {0, -1, 0})}, e, 0.15), -1);
  EXPECT_EQ(free_side(std::vector{object_pair(0.05, {0, 1, 0})}, e, 0.15), 1);
  // The nearer of two decides; one beyond `reach` does not count.
  EXPECT_EQ(free_side(std::vector{object_pair(0.02, {0, 1, 0}), object_pair(0.1, {0, -1, 0})}, e, 0.15), 1);
  EXPECT_EQ(free_side(std::vector{object_pair(0.2, {0, -1, 0})}, e, 0.15), 1);
  ProximityPair self = object_pair(0.0, {0, -1, 0});
  self.kind = PairKind::kSelf;
  EXPECT_EQ(free_side(std::vector{self}, e, 0.15), 1);
}

TEST(Detour, TargetsTurnToOneSideThenTheOtherThenBack) {
  Scene scene;
  scene.pairs = {object_pair(0.05, {-1, -0.3, 0})};
  for (int n = 0; n < 14; ++n) {
    scene.until_stagnation(n + 1, 3000);
    const EscapeState& state = scene.escape.state();
    EXPECT_EQ(state.side, -1);
    const double alpha = n % 3 == 2 ? kPi : (n % 3 == 0 ? -1 : 1) * scene.params.angle;
    const double length = std::min(scene.params.length * (1 + scene.params.growth * n), scene.params.max_length);
    const Vector3 from(0, 0, scene.kinematics.X_WE().translation().z());
    EXPECT_LT((state.target_W - from - length * Vector3(std::cos(alpha), std::sin(alpha), 0)).norm(), 1e-12) << n;
    EXPECT_NEAR(state.remaining, scene.params.duration * (1 + scene.params.growth * n), 1e-9) << n;
  }
}

TEST(Detour, AroundTheArmsRootWhereTheBaseIsFixed) {
  Scene scene(panda());
  scene.goal.X_WG.translation() += Vector3(-1, -1, 0);  // e = -y
  for (int n = 0; n < 6; ++n) {
    scene.until_stagnation(n + 1, 3000);
    const Vector3 to = scene.escape.state().target_W;
    const double alpha = (n % 3 == 2 ? kPi : (n % 3 == 0 ? 1 : -1) * scene.params.angle) - kPi / 2;
    // Joint to joint the test's Panda measures 0.333, 0.316, 0.0825, 0.393, 0.088 and 0.2104 m.
    const double length =
        std::min(0.75 * (1 + 0.2 * n), 0.5 * (0.333 + 0.316 + 0.0825 + std::hypot(0.0825, 0.384) + 0.088 + 0.2104));
    EXPECT_NEAR(to.x(), length * std::cos(alpha), 1e-9) << n;
    EXPECT_NEAR(to.y(), length * std::sin(alpha), 1e-9) << n;
  }
}

TEST(Detour, BendsTheTaskAndEndsInTime) {
  Scene scene;
  const int start = scene.until_stagnation(1);
  EXPECT_GT(start, 0);
  EXPECT_TRUE(scene.task.detour);
  const Vector3 to_target = scene.escape.state().target_W - scene.kinematics.X_WE().translation();
  EXPECT_GT(scene.task.nu.tail<3>().normalized().dot(to_target.normalized()), 1 - 1e-12);
  EXPECT_LE(scene.task.nu.tail<3>().norm(), scene.servo.max_linear);
  EXPECT_EQ(scene.task.slack_scale.head<3>(), Vector3::Constant(scene.params.slack_factor));
  EXPECT_EQ(scene.task.slack_scale.tail<3>(), Vector3::Ones());
  int steps = 0;
  while (scene.step().detour) ++steps;
  EXPECT_NEAR(steps + 1, periods(scene.params.duration), 1);
  EXPECT_FALSE(scene.task.detour);
  EXPECT_EQ(scene.task.slack_scale, Vector6::Ones());
  EXPECT_EQ(scene.escape.state().best, remaining_way(scene.params, scene.task.error));
}

TEST(Detour, EndsAtItsTarget) {
  Scene scene;
  scene.until_stagnation(1);
  const Vector3 p = scene.escape.state().target_W - scene.kinematics.X_WE().translation();
  EscapeState state = scene.escape.state();
  scene.kinematics.update(Vector3(p.x(), p.y() + 0.9 * scene.params.reached, 0), scene.kinematics.q());
  scene.escape.set_state(state);
  EXPECT_FALSE(scene.step().detour);
}

TEST(Detour, OffLeavesTheTaskAlone) {
  Scene scene(frankie(), EscapeParams{});
  for (int i = 0; i < 300; ++i) {
    scene.step();
    ASSERT_EQ(scene.task.nu, servo_twist(scene.servo, scene.task.error, scene.goal.V_WG_W));
    ASSERT_EQ(scene.task.slack_scale, Vector6::Ones());
  }
  EXPECT_EQ(scene.escape.state().stagnations, 0);
}

}  // namespace
}  // namespace moma
