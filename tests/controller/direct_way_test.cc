// Direct ways against coal's distances, forward kinematics and differences; the steered drive against a unicycle; the
// same way however its work is spread; no memory taken.
#include "controller/plan/direct_way.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "tests/controller/path_limits.h"
#include "tests/controller/plan_scenes.h"
#include "tests/support/no_alloc.h"

namespace moma::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr long kAll = 1L << 40;

class Drives : public testing::TestWithParam<double> {};

INSTANTIATE_TEST_SUITE_P(WheelSpeeds, Drives, testing::Values(20.0, 11.0),
                         [](const auto& param) { return "Of" + std::to_string(static_cast<int>(param.param)); });

// A unicycle that is driven by the speeds of the path comes to its end, within what base and wheels can do.
TEST_P(Drives, AUnicycleFollowsWithinItsLimits) {
  RobotModel model = *load_model("configs/robots/frankie.yaml");
  model.base.wheels->max_speed = GetParam();
  const MotionLimits limits(model, plan_params(model));
  std::mt19937_64 engine(1);
  SteeredDrive drive;
  int reached = 0;
  double steered = 0.0, straight = 0.0, fastest_wheel = 0.0;
  constexpr int kDrives = 300;
  for (int k = 0; k < kDrives; ++k) {
    const double bearing = uniform_in(engine, -kPi, kPi), away = uniform_in(engine, 0.0, 4.0);
    const Vector3 from(uniform_in(engine, -2.0, 2.0), uniform_in(engine, -2.0, 2.0), uniform_in(engine, -4.0, 4.0));
    const Vector2 point = from.head<2>() + away * Vector2(std::cos(bearing), std::sin(bearing));
    if (!drive.plan(limits, from, Vector2::Zero(), point)) continue;
    ++reached;
    Path path;
    path.origin = from;
    drive.add_to(path);
    ASSERT_EQ(path.duration, drive.time());
    WholeConfiguration c;
    path.at(path.duration, c);
    EXPECT_LT((c - drive.end()).norm(), 1e-9);
    EXPECT_LT((drive.end().head<2>() - point).norm(), 0.05) << "drive " << k;

    const double h = 0.001;
    WholeConfiguration before, after;
    Vector3 unicycle = from;
    double v_before = 0.0, omega_before = 0.0, way = 0.0, turned = 0.0;
    for (double t = 0.5 * h; t < path.duration + h; t += h) {
      path.at(t - 0.5 * h, before);
      path.at(t + 0.5 * h, after);
      const Vector3 u = (after - before) / h;
      const double heading = 0.5 * (before[2] + after[2]);
      const double v = std::cos(heading) * u.x() + std::sin(heading) * u.y();
      constexpr double kMore = 1.0 + 1e-6, kBetweenNodes = 1.1;
      ASSERT_LE(std::abs(v), kMore * limits.linear) << "drive " << k << " at " << t;
      ASSERT_LE(std::abs(u.z()), kMore * limits.angular);
      ASSERT_LE(std::abs(v - v_before) / h, kBetweenNodes * limits.linear_acceleration) << "drive " << k << " at " << t;
      ASSERT_LE(std::abs(u.z() - omega_before) / h, kMore * limits.angular_acceleration);
      ASSERT_LE(std::abs(-std::sin(heading) * u.x() + std::cos(heading) * u.y()), 0.06) << "sideways at " << t;
      fastest_wheel = std::max(fastest_wheel, std::abs(v) + limits.half_track * std::abs(u.z()));
      unicycle += h * Vector3(v * std::cos(heading), v * std::sin(heading), u.z());
      way += h * std::abs(v);
      turned += h * std::abs(u.z());
      v_before = v;
      omega_before = u.z();
    }
    EXPECT_LT(std::abs(v_before) + std::abs(omega_before), 0.02) << "it ends at rest";
    EXPECT_LT((unicycle - drive.end()).norm(), 0.02) << "drive " << k;
    EXPECT_NEAR(drive.way(), way, 0.02 + 0.05 * way);
    EXPECT_NEAR(drive.turned(), turned, 0.02 + 0.05 * turned);

    WholeConfiguration to = drive.end();
    to[2] = std::atan2(to[1] - from[1], to[0] - from[0]);
    head_along(limits, from, 0.0, to);
    steered += drive.time();
    Edge edge;
    make_edge(limits, from, to, edge);
    straight += edge.time;
  }
  EXPECT_GT(reached, 0.8 * kDrives);
  EXPECT_LT(steered, 0.95 * straight) << "turning on the spot first takes longer";
  EXPECT_LE(fastest_wheel, 1.01 * limits.rim_speed);
  EXPECT_GT(fastest_wheel, 0.6 * limits.rim_speed);
}

TEST(SteeredDrive, BeginsAtItsSpeeds) {
  const auto model = load_model("configs/robots/frankie.yaml");
  const MotionLimits limits(*model, plan_params(*model));
  std::mt19937_64 engine(3);
  SteeredDrive drive;
  int reached = 0;
  for (int k = 0; k < 100; ++k) {
    const double bearing = uniform_in(engine, -kPi, kPi), away = uniform_in(engine, 0.0, 4.0);
    const Vector3 from(0.5, -1.0, uniform_in(engine, -4.0, 4.0));
    const Vector2 now(uniform_in(engine, -limits.linear, limits.linear),
                      uniform_in(engine, -0.5 * limits.angular, 0.5 * limits.angular));
    const Vector2 point = from.head<2>() + away * Vector2(std::cos(bearing), std::sin(bearing));
    if (!drive.plan(limits, from, now, point)) continue;
    ++reached;
    Path path;
    path.origin = from;
    drive.add_to(path);
    const double h = 0.001;
    WholeConfiguration c;
    path.at(h, c);
    const Vector3 u = (c - from) / h;
    EXPECT_NEAR(u.x(), now[0] * std::cos(from.z()), 0.02) << "drive " << k;
    EXPECT_NEAR(u.y(), now[0] * std::sin(from.z()), 0.02) << "drive " << k;
    EXPECT_NEAR(u.z(), now[1], 0.02) << "drive " << k;
    path.at(path.duration, c);
    EXPECT_LT((c - drive.end()).norm(), 1e-9);
    EXPECT_LT((drive.end().head<2>() - point).norm(), 0.06) << "drive " << k;
  }
  EXPECT_GT(reached, 70);
}

TEST(SteeredDrive, APointThatIsReachedNeedsNoDrive) {
  const auto model = load_model("configs/robots/frankie.yaml");
  const MotionLimits limits(*model, plan_params(*model));
  SteeredDrive drive;
  const Vector3 from(1.0, -1.0, 0.5);
  ASSERT_TRUE(drive.plan(limits, from, Vector2::Zero(), from.head<2>()));
  EXPECT_EQ(drive.time(), 0.0);
  EXPECT_EQ(drive.end(), from);
  Path path;
  drive.add_to(path);
  EXPECT_EQ(path.count, 0);
}

ControllerParams few_tries(ControllerParams params) {
  params.plan.direct_way.pass_tries = 200;
  return params;
}

class DirectWayOf : public testing::TestWithParam<std::string> {
 protected:
  DirectWayOf()
      : model(load_model(GetParam())),
        params(few_tries(plan_params(*model))),
        direct(model, params),
        velocity(WholeConfiguration::Zero(3 + model->num_joints())) {}

  bool find(const Scene& scene, long per_step = kAll) {
    direct.set_objects(scene.shapes);
    const NoAlloc guard;
    if (next)
      direct.begin_passing({scene.start, velocity}, scene.X_WG, *next, pass, pass, kInfinity, 1, scene.states);
    else
      direct.begin({scene.start, velocity}, scene.X_WG, scene.states);
    long budget = per_step;
    while (direct.advance(budget)) budget = per_step;
    EXPECT_EQ(guard.count(), 0);
    return direct.found();
  }

  std::shared_ptr<const RobotModel> model;
  ControllerParams params;
  DirectWay direct;
  WholeConfiguration velocity;   // of the start
  std::optional<Isometry> next;  // goal after the scene's
  WholeConfiguration pass;       // configuration at the scene's goal
};

std::vector<std::string> direct_robots() {
  std::vector<std::string> robots = plan_robots();
  robots.push_back("configs/robots/ur5.yaml");
  return robots;
}

INSTANTIATE_TEST_SUITE_P(Robots, DirectWayOf, testing::ValuesIn(direct_robots()),
                         [](const auto& param) { return test_name(param.param); });

TEST_P(DirectWayOf, WaysAreFreeAndLeadToTheGoalWithinLimits) {
  const MotionLimits& limits = direct.limits();
  const int joints = model->num_joints();
  Kinematics kinematics(model);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Scene scene = make_scene(model, seed, 6);
    for (int i = 0; i < joints; ++i)  // a joint that winds begins in another turn than the goal was drawn in
      if (limits.winds[i] != 0 && seed % 3 == 0)
        scene.start[3 + i] += scene.start[3 + i] > 0.0 ? -kFullTurn : kFullTurn;
    if (!find(scene)) continue;
    ++found;
    const Path& path = direct.path();
    WholeConfiguration c;
    path.at(0.0, c);
    EXPECT_EQ((c - scene.start).norm(), 0.0);
    kinematics.update(c.head<3>(), c.tail(joints));
    const double own_at_start = own_clearance(*model, kinematics);
    double least = 1e9, own = 1e9;
    for (double t = 0.0; t < path.duration + 0.01; t += 0.01) {
      path.at(t, c);
      for (int i = 0; i < joints; ++i) {
        ASSERT_GE(c[3 + i], limits.lower[i]) << "joint " << i << ", seed " << seed;
        ASSERT_LE(c[3 + i], limits.upper[i]) << "joint " << i << ", seed " << seed;
        ASSERT_TRUE(limits.winds[i] == 0 || std::abs(c[3 + i] - scene.start[3 + i]) <= kFullTurn);
      }
      kinematics.update(c.head<3>(), c.tail(joints));
      least = std::min(least, object_clearance(*model, kinematics, scene));
      own = std::min(own, own_clearance(*model, kinematics));
    }
    // Less what may happen between two checks.
    EXPECT_GT(least, path.clearance - 0.01) << "seed " << seed;
    EXPECT_GT(own, std::min(params.plan.self, own_at_start) - 0.01) << "seed " << seed;
    EXPECT_LT((kinematics.X_WE().translation() - scene.X_WG.translation()).norm(), 1e-3);
    EXPECT_LT(log_so3(kinematics.X_WE().linear() * scene.X_WG.linear().transpose()).norm(), 2e-3);

    const Extremes most = extremes(path);
    expect_within(limits, most, seed);
    if (model->mobile()) {
      EXPECT_LE(most.speed.head<2>().maxCoeff(), kDifferences * limits.linear);
    }
    if (model->mobile() && !limits.base->nonholonomic()) {  // the others: Drives
      EXPECT_LE(most.acceleration.head<2>().maxCoeff(), kDifferences * limits.linear_acceleration);
    }
  }
  EXPECT_GE(found, 4) << "too few to say anything";
}

// A base whose drive follows with half of its accelerations: ways ask for no more, and take longer.
TEST_P(DirectWayOf, KeepsToTheShareOfTheDrive) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  const MotionLimits full = direct.limits();
  double before = 0.0, slower = 0.0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Scene scene = make_scene(model, seed, 0);
    direct.set_drive(1.0);
    if (!find(scene)) continue;
    const double time = direct.path().duration;
    direct.set_drive(0.5);
    if (!find(scene)) continue;
    before += time;
    slower += direct.path().duration;
    const Extremes most = extremes(direct.path());
    EXPECT_LE(most.acceleration[2], kDifferences * 0.5 * full.angular_acceleration) << "seed " << seed;
    if (full.base->lateral()) {
      EXPECT_LE(most.acceleration.head<2>().maxCoeff(), kDifferences * 0.5 * full.linear_acceleration);
    }
  }
  EXPECT_GT(slower, 1.05 * before);
}

// From a motion it begins at the robot's velocity, and joints and an omnidirectional base keep their accelerations from
// there on: what slows down and what speeds up add.
TEST_P(DirectWayOf, BeginsAtTheVelocityThatTheRobotHas) {
  const MotionLimits& limits = direct.limits();
  const int joints = model->num_joints();
  std::mt19937_64 engine(5);
  Kinematics kinematics(model);
  int found = 0;
  double moving = 0.0, resting = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = make_scene(model, seed, 2);
    velocity.setZero();
    if (!find(scene)) continue;
    const Path from_rest = direct.path();
    WholeConfiguration end;
    from_rest.at(from_rest.duration, end);
    for (int i = 0; i < joints; ++i) velocity[3 + i] = uniform_in(engine, -0.6, 0.6) * limits.joint_speed[i];
    if (seed % 2 == 0)
      velocity.tail(joints) =
          (0.5 * (end - scene.start).tail(joints)).cwiseMax(-limits.joint_speed).cwiseMin(limits.joint_speed);
    if (model->mobile()) {
      velocity.head<2>() = 0.7 * limits.linear * Vector2(std::cos(scene.start[2]), std::sin(scene.start[2]));
      velocity[2] = uniform_in(engine, -0.5, 0.5) * limits.angular;
    }
    if (!find(scene)) continue;
    ++found;
    if (seed % 2 == 0) {
      moving += direct.path().duration;
      resting += from_rest.duration;
    }
    const Path& path = direct.path();
    const double h = 0.001;
    WholeConfiguration before, now, after;
    path.at(0.0, before);
    EXPECT_EQ((before - scene.start).norm(), 0.0);
    path.at(h, now);
    EXPECT_LT(((now - before) / h - velocity).lpNorm<Eigen::Infinity>(), 0.03) << "seed " << seed;
    for (double t = 2.0 * h; t < path.duration; t += h) {
      path.at(t, after);
      const WholeConfiguration a = (after - 2.0 * now + before) / (h * h), v = (after - now) / h;
      for (int i = 0; i < joints; ++i) {
        ASSERT_LE(std::abs(a[3 + i]), 1.0001 * limits.joint_acceleration[i]) << "joint " << i << ", seed " << seed;
        ASSERT_LE(std::abs(v[3 + i]), 1.0001 * limits.joint_speed[i]) << "joint " << i << ", seed " << seed;
      }
      if (limits.base->lateral()) {
        ASSERT_LE(a.head<2>().norm(), 1.0001 * limits.linear_acceleration) << "seed " << seed;
        ASSERT_LE(std::abs(a[2]), 1.0001 * limits.angular_acceleration) << "seed " << seed;
        ASSERT_LE(v.head<2>().norm(), 1.0001 * limits.linear) << "seed " << seed;
      }
      before = now;
      now = after;
    }
    path.at(path.duration, now);
    kinematics.update(now.head<3>(), now.tail(joints));
    EXPECT_LT((kinematics.X_WE().translation() - scene.X_WG.translation()).norm(), 1e-3);
    EXPECT_LT(log_so3(kinematics.X_WE().linear() * scene.X_WG.linear().transpose()).norm(), 2e-3);
  }
  EXPECT_GE(found, 3) << "too few to say anything";
  if (!model->mobile()) {
    EXPECT_LT(moving, resting) << "a robot that moves that way already is there sooner";
  }
}

// Tries around the end of the best way never make it longer, and mostly shorter.
TEST_P(DirectWayOf, TriesAroundTheBestEndShortenTheWay) {
  ControllerParams without = params;
  without.plan.direct_way.around_tries = 0;
  DirectWay first(model, without);
  int found = 0, shorter = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const Scene scene = make_scene(model, seed, 3);
    first.set_objects(scene.shapes);
    first.begin({scene.start, velocity}, scene.X_WG, scene.states);
    long budget = kAll;
    first.advance(budget);
    ASSERT_EQ(find(scene), first.found()) << "seed " << seed;
    if (!first.found()) continue;
    ++found;
    EXPECT_LE(direct.path().duration, first.path().duration + 1e-9) << "seed " << seed;
    if (direct.path().duration < 0.999 * first.path().duration) ++shorter;
  }
  EXPECT_GE(found, 6) << "too few to say anything";
  // Configurations of six joints that hold a goal are apart: there is nothing near the best one.
  if (model->num_velocities() > 6) {
    EXPECT_GT(shorter, found / 2) << "of " << found;
  }
}

// A goal that need not be stopped at: the hand is there in passing, and the robot ends at the next goal, sooner than by
// one way after the other.
TEST_P(DirectWayOf, PassesAGoalOnItsWayToTheNextOne) {
  const MotionLimits& limits = direct.limits();
  const int joints = model->num_joints();
  Kinematics kinematics(model);
  int found = 0;
  double passing = 0.0, stopping = 0.0, fastest = 0.0;
  const auto errors = [&](const Path& path, double t, const Isometry& X) {
    WholeConfiguration c;
    path.at(t, c);
    kinematics.update(c.head<3>(), c.tail(joints));
    return pose_error(kinematics.X_WE(), X);
  };
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Scene scene = make_scene(model, seed, 3);
    const Scene other = make_scene(model, seed + 100, 0);
    next.reset();
    if (!find(scene)) continue;
    const Path there = direct.path();
    ASSERT_FALSE(there.passes());
    next = other.X_WG;
    there.at(there.duration, pass);
    if (!find(scene)) continue;
    ASSERT_TRUE(direct.path().passes());
    const Path path = direct.path();
    for (const double t : {path.pass, path.duration}) {
      const Vector6 e = errors(path, t, t == path.pass ? scene.X_WG : other.X_WG);
      EXPECT_LT(e.tail<3>().norm(), 2e-3) << "seed " << seed << " at " << t;
      EXPECT_LT(e.head<3>().norm(), 4e-3) << "seed " << seed << " at " << t;
    }
    const double h = 0.01;
    const Vector6 e = errors(path, path.pass - h, scene.X_WG) - errors(path, path.pass + h, scene.X_WG);
    EXPECT_LE(e.tail<3>().norm() / (2.0 * h), params.plan.direct_way.pass_linear + 0.1) << "seed " << seed;
    EXPECT_LE(e.head<3>().norm() / (2.0 * h), params.plan.direct_way.pass_angular + 0.2) << "seed " << seed;
    WholeConfiguration v;
    path.velocity(path.pass, h, v);
    if (model->mobile()) fastest = std::max(fastest, v.head<2>().norm());

    double least = 1e9;
    WholeConfiguration c;
    for (double t = 0.0; t < path.duration; t += 0.01) {
      path.at(t, c);
      kinematics.update(c.head<3>(), c.tail(joints));
      least = std::min(least, object_clearance(*model, kinematics, scene));
    }
    EXPECT_GT(least, path.clearance - 0.01) << "seed " << seed;
    expect_within(limits, extremes(path), seed);
    scene.start = pass;
    scene.X_WG = other.X_WG;
    next.reset();
    if (!find(scene)) continue;
    ++found;
    passing += path.duration;
    stopping += there.duration + direct.path().duration;
  }
  EXPECT_GE(found, 3) << "too few to say anything";
  if (model->mobile()) {  // a fixed arm has hardly anything to gain
    EXPECT_LT(passing, stopping);
    EXPECT_GT(fastest, 0.5 * limits.linear) << "no base drives on";
  }
}

TEST_P(DirectWayOf, TheSameWayHoweverItIsSpread) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Scene scene = make_scene(model, seed, 4);
    if (!find(scene)) continue;
    ++found;
    const Path whole = direct.path();
    for (const long per_step : {300L, 7L}) {
      ASSERT_TRUE(find(scene, per_step));
      const Path& path = direct.path();
      ASSERT_EQ(path.count, whole.count);
      ASSERT_EQ(path.duration, whole.duration);
      for (std::size_t k = 0; k < static_cast<std::size_t>(path.count); ++k)
        ASSERT_EQ((path.motions[k].change - whole.motions[k].change).norm(), 0.0);
    }
  }
  EXPECT_GT(found, 0);
}

// Of ways to many ends it is the quickest: those of the planner, which keeps more of the speeds to itself, take longer.
TEST_P(DirectWayOf, IsQuickerThanAPlannedPath) {
  Planner planner(model, params);
  double steered = 0.0, planned = 0.0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Scene scene = make_scene(model, seed, 0);
    if (!plan_whole(planner, scene, seed) || !find(scene)) continue;
    steered += direct.path().duration;
    planned += planner.path().duration;
  }
  EXPECT_GT(steered, 0.0);
  EXPECT_LT(steered, planned);
}

TEST_P(DirectWayOf, ThereIsNoneThroughAWallOrToAGoalInAnObject) {
  Scene scene = make_scene(model, 1, 0);
  ASSERT_TRUE(find(scene));
  scene.shapes = {{"ball", make_sphere(0.02)}};
  scene.states.resize(1);
  scene.states[0].X_WO.translation() = scene.X_WG.translation();
  direct.set_objects(scene.shapes);
  direct.begin({scene.start, velocity}, scene.X_WG, scene.states);
  long budget = kAll;
  EXPECT_FALSE(direct.advance(budget));
  EXPECT_EQ(budget, kAll) << "it is known at once";
  EXPECT_FALSE(direct.found());
  if (model->mobile()) {
    EXPECT_FALSE(find(behind_a_wall(model, 1)));
  }
}

}  // namespace
}  // namespace moma::test
