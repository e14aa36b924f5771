// Stagnation, detours and the vortex, step by step on made-up situations.

#include "controller/task/escape.h"

#include <gtest/gtest.h>

#include "controller/task/servo.h"
#include "tests/controller/qp_robots.h"
#include "tests/support/control_period.h"

namespace moma {
namespace {

using namespace test;

const std::vector<ObjectState> kStill(4);

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
  std::vector<ObjectState> objects;
  const Proximity* proximity = nullptr;
  Escape escape;
  Task task;

  explicit Scene(std::shared_ptr<const RobotModel> m = frankie(), const EscapeParams& e = on(), ServoParams s = {})
      : model(std::move(m)), kinematics(model), params(e), servo(s), objects(2), escape(e, s, *model, kPeriod) {
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
    escape.update({kinematics, goal, pairs, objects, false, proximity}, task);
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

TEST(Stagnation, AFollowedGoalIsProgressAGoalThatComesIsToo) {
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
  // It comes to a robot that waits.
  Scene come;
  for (int i = 0; i < 200; ++i) {
    come.goal.V_WG_W << 0, 0, 0, -0.1, 0, 0;
    come.step();
    come.approach(0.1 * kPeriod);
  }
  EXPECT_EQ(come.escape.state().stagnations, 0);
}

TEST(Stagnation, TrafficIsWaitedForLonger) {
  Scene scene;
  scene.pairs = {object_pair(0.1, {-1, 0, 0}), object_pair(0.2, {0, 1, 0}, 1)};
  scene.objects[1].V_WO_W << 0, 0, 0, 0, -0.2, 0;
  EXPECT_NEAR(scene.until_stagnation(1, 2000), periods(scene.params.traffic_patience) + 1, 1);
  // Once it has gone the usual patience holds at once.
  Scene gone;
  gone.pairs = scene.pairs;
  gone.objects = scene.objects;
  for (int i = 0; i < periods(2.0 * gone.params.patience); ++i) gone.step();
  EXPECT_EQ(gone.escape.state().stagnations, 0);
  gone.pairs.pop_back();
  EXPECT_EQ(gone.step().stagnations, 1);
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

TEST(Detour, GoesAroundWhatLiesBetween) {
  EscapeParams params = Scene::on();
  params.around = {.enabled = true, .clearance = 0.05, .reach = 0.5, .passed = 0.3, .duration = 4.0};
  Scene scene(frankie(), params);
  scene.goal.X_WG.translation().x() = 4.0;
  Proximity proximity(scene.model);
  const ObjectShape wall{"wall", {ShapeKind::kBox, {0.1, 1.0, 1.0}, nullptr}};
  proximity.set_objects({&wall, 1});
  scene.objects.resize(1);
  scene.objects[0].X_WO = pose(2.0, 0.2, 0.5, 0, 0, 0);  // to the right it ends at y = -0.3
  scene.proximity = &proximity;
  scene.escape.allocate(1);
  scene.until_stagnation(1);
  EscapeState state = scene.escape.state();
  EXPECT_TRUE(state.detour && state.around);
  EXPECT_NEAR(state.remaining, 4.0, 1e-12);
  const double z = scene.kinematics.X_WE().translation().z();
  EXPECT_EQ(state.target_W.z(), z);
  // Corners of the octagon about the wall's shadow, which is grown by the base's 0.3 m and 0.05 m.
  EXPECT_NEAR(state.target_W.y(), -0.3 - 0.35, 0.05);
  const double first = state.target_W.x();
  EXPECT_LT(first, 2.0);
  const auto place = [&](double x, double y) {
    const Vector3 p_BE = scene.kinematics.X_WE().translation() - scene.kinematics.X_WB().translation();
    scene.kinematics.update(Vector3(x - p_BE.x(), y - p_BE.y(), 0), scene.kinematics.q());
  };
  place(first - 0.35, state.target_W.y());
  EXPECT_EQ(scene.step().target_W.x(), first) << "not there yet";
  place(first - 0.25, state.target_W.y());
  state = scene.step();
  EXPECT_TRUE(state.around);
  EXPECT_GT(state.target_W.x(), 2.0) << "the next corner is beyond the wall";
  place(state.target_W.x(), state.target_W.y());
  state = scene.step();
  EXPECT_FALSE(state.detour || state.around) << "the rest of the way is straight";

  // Without an obstacle between, the detour is one to a side.
  scene.escape.reset();
  scene.kinematics.update(Vector3::Zero(), scene.kinematics.q());
  scene.objects[0].X_WO.translation().y() = 2.0;
  scene.until_stagnation(1);
  EXPECT_TRUE(scene.escape.state().detour);
  EXPECT_FALSE(scene.escape.state().around);
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

// The formula of vortex.h written out for two obstacles, in components.
TEST(Vortex, AgainstTheFormula) {
  VortexParams params;
  params.enabled = true;
  const std::vector<ProximityPair> pairs = {object_pair(0.01, {-1, 0.2, 0.1}), object_pair(0.04, {-0.6, -1, 0.3}, 1),
                                            object_pair(0.1, {1, 0, 0}), object_pair(0.3, {-1, 0, 0})};
  const Vector3 e_p(0.6, 0.1, -0.05);
  const Vector3 nu0(0.5, 0.1, 0.02);
  for (const int sigma : {1, -1}) {
    double S = 0, sx = 0, sy = 0;
    for (const ProximityPair& pair : pairs) {
      const Vector3 n = pair.distance.n_W;
      const double cosine = -(n.x() * e_p.x() + n.y() * e_p.y() + n.z() * e_p.z()) / std::sqrt(0.3725);
      const double near = 1 - pair.distance.d / 0.2;
      if (cosine <= 0 || near <= 0) continue;
      const double w = near * cosine, flat = std::sqrt(n.x() * n.x() + n.y() * n.y());
      S += w;
      sx += -w * sigma * n.y() / flat;
      sy += w * sigma * n.x() / flat;
    }
    ASSERT_GT(S, 1.1) << "where the strength no longer grows";
    const double speed = std::sqrt(0.25 + 0.01 + 0.0004), strength = 2.5 * std::min(S, 1.0) / S;
    Vector3 u(0.5 / speed + strength * sx, 0.1 / speed + strength * sy, 0.02 / speed);
    u *= speed / u.norm();
    Vector3 nu = nu0;
    int circulation = sigma;
    add_vortex(params, pairs, kStill, e_p, circulation, nu);
    EXPECT_LT((nu - u).norm(), 1e-12) << sigma;
    EXPECT_NEAR(nu.norm(), nu0.norm(), 1e-12);
    EXPECT_EQ(circulation, sigma);
  }
}

TEST(Vortex, ChoosesTheSideOnceAndFlipsWhenStagnating) {
  ServoParams servo;
  servo.vortex.enabled = true;
  servo.vortex.when = VortexWhen::kAlways;
  Scene scene(frankie(), EscapeParams{}, servo);
  scene.pairs = {object_pair(0.19, {-0.2, 1, 0})};
  scene.step();
  EXPECT_EQ(scene.escape.state().circulation, 0) << "S is below the threshold";
  scene.pairs = {object_pair(0.05, {-1, 0.2, 0})};
  scene.step();
  // t = sigma (-n_y, n_x): forward (e = x) for sigma = -1.
  EXPECT_EQ(scene.escape.state().circulation, -1);
  EXPECT_GT(scene.task.nu.y(), -10.0);
  scene.until_stagnation(1);
  EXPECT_EQ(scene.escape.state().circulation, 1);
  EXPECT_FALSE(scene.escape.state().detour) << "detours are off";
}

TEST(Vortex, StagnatedMeansNotBefore) {
  ServoParams servo;
  servo.vortex.enabled = true;
  Scene scene(frankie(), EscapeParams{}, servo);
  scene.pairs = {object_pair(0.05, {-1, 0.2, 0})};
  scene.step();
  EXPECT_EQ(scene.task.nu, servo_twist(scene.servo, scene.task.error, scene.goal.V_WG_W));
  scene.until_stagnation(1);
  scene.step();
  EXPECT_NE(scene.task.nu, servo_twist(scene.servo, scene.task.error, scene.goal.V_WG_W));
}

TEST(Vortex, LeavesObjectsInMotionToTheirRows) {
  VortexParams params;
  params.enabled = true;
  const std::vector pairs = {object_pair(0.05, {-1, 0.2, 0}, 1)};
  std::vector<ObjectState> objects(2);
  int circulation = 1;
  Vector3 nu(0.3, 0, 0);
  objects[1].V_WO_W[4] = 0.2;
  add_vortex(params, pairs, objects, {1, 0, 0}, circulation, nu);
  EXPECT_EQ(nu, Vector3(0.3, 0, 0));
  objects[1].V_WO_W.setZero();
  add_vortex(params, pairs, objects, {1, 0, 0}, circulation, nu);
  EXPECT_NE(nu, Vector3(0.3, 0, 0));
}

// nu moves by no more than in proportion to what moves: obstacles that enter, pass by, and a goal that is near.
TEST(Vortex, Continuous) {
  Rng rng(3);
  VortexParams params;
  params.enabled = true;
  double worst = 0.0;
  for (int trial = 0; trial < 2000; ++trial) {
    // Obstacles that stand on the floor; straight above or below E the direction around them is open.
    std::vector<ProximityPair> pairs;
    for (int i = 0; i < 4; ++i) {
      Vector3 n = random_vector(rng, 1.0);
      n.z() *= 0.3;
      if (n.head<2>().norm() < 0.3) n.x() = 0.5;
      pairs.push_back(object_pair(uniform(rng, 0.0, 0.25), n, i));
    }
    const Vector3 e_p = random_vector(rng, 0.6) + Vector3(0.7, 0, 0);
    const auto nu_at = [&](double step) {
      std::vector<ProximityPair> moved = pairs;
      for (ProximityPair& p : moved) {
        p.distance.d += step;
        p.distance.n_W = (p.distance.n_W + Vector3(step, -step, 0)).normalized();
      }
      Vector3 nu = 0.8 * e_p.normalized();
      int circulation = 1;
      add_vortex(params, moved, kStill, e_p + Vector3(step, step, step), circulation, nu);
      return nu;
    };
    const double h = 1e-6;
    worst = std::max(worst, (nu_at(h) - nu_at(-h)).norm() / (2 * h));
  }
  EXPECT_LT(worst, 2e4) << "m/s per m; a jump would be of the order of 1/h = 5e5";
}

TEST(Vortex, NothingToDoLeavesNuAlone) {
  VortexParams params;
  params.enabled = true;
  int circulation = 0;
  Vector3 nu(0.3, 0, 0);
  add_vortex(params, {}, kStill, {1, 0, 0}, circulation, nu);
  EXPECT_EQ(nu, Vector3(0.3, 0, 0));
  const std::vector above = {object_pair(0.05, {0, 0, 1})};
  add_vortex(params, above, kStill, {0, 0, -1}, circulation, nu);
  EXPECT_EQ(nu, Vector3(0.3, 0, 0));
  nu.setZero();
  add_vortex(params, std::vector{object_pair(0.05, {-1, 0, 0})}, kStill, {1, 0, 0}, circulation, nu);
  EXPECT_EQ(nu, Vector3::Zero());
}

}  // namespace
}  // namespace moma
