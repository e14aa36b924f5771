// Paths past corners against differences, forward kinematics and coal's distances; routes against the way round a wall
// by hand.
#include "controller/plan/smooth_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "controller/plan/free_space.h"
#include "controller/plan/route.h"
#include "controller/plan/tuck.h"
#include "tests/controller/path_limits.h"
#include "tests/controller/plan_scenes.h"

namespace moma::test {
namespace {

// A wall across the way to x = 3, from y = -1.1 to 1.9.
Scene wall() {
  Scene scene;
  scene.shapes = {{"wall", make_box(0.2, 3.0, 2.0)}};
  scene.states.resize(1);
  scene.states[0].X_WO.translation() << 1.5, 0.4, 1.0;
  return scene;
}

class Smooth : public testing::TestWithParam<std::string> {
 protected:
  Smooth()
      : model(load_model(GetParam())),
        params(plan_params(*model)),
        limits(*model, params),
        space(model, limits),
        ik(model, params.plan.ik, limits),
        smooth(limits, params.plan, space, ik) {}

  void put(const Scene& scene, const WholeConfiguration& start, double clearance) {
    space.set_objects(scene.shapes);
    space.set_states(scene.states);
    space.set_clearances({clearance, -1.0, -1.0}, start);
  }
  // A start, some corners 0.5 to 2 m apart, and an end, with the arm a little off `ready`.
  std::vector<WholeConfiguration> drawn(std::mt19937_64& engine) const {
    std::vector<WholeConfiguration> corners;
    WholeConfiguration c = WholeConfiguration::Zero(3 + model->num_joints());
    for (int k = 0; k < 4; ++k) {
      c.tail(model->num_joints()) = model->ready;
      for (int i = 0; i < model->num_joints(); ++i)
        c[3 + i] = std::clamp(c[3 + i] + uniform_in(engine, -0.3, 0.3), limits.lower[i] + 1.5 * limits.margin[i],
                              limits.upper[i] - 1.5 * limits.margin[i]);
      corners.push_back(c);
      const double bearing = uniform_in(engine, -2.0, 2.0), way = uniform_in(engine, 0.5, 2.0);
      c.head<3>() += Vector3(way * std::cos(bearing), way * std::sin(bearing), uniform_in(engine, -1.0, 1.0));
    }
    return corners;
  }
  // Configurations at the origin with the arm tucked.
  std::vector<WholeConfiguration> tucked(std::size_t count) {
    WholeConfiguration c = WholeConfiguration::Zero(3 + model->num_joints());
    c.tail(model->num_joints()) = tucked_arm(*model, space, {-1.0, 0.0, 0.0});
    return std::vector<WholeConfiguration>(count, c);
  }
  double time_of_edges(const std::vector<WholeConfiguration>& corners) const {
    double sum = 0.0;
    for (std::size_t k = 0; k + 1 < corners.size(); ++k) sum += edge_time(limits, corners[k], corners[k + 1]);
    return sum;
  }
  bool run(const std::vector<WholeConfiguration>& corners, const Braking& braking = {}) {
    smooth.begin(corners, braking, 1e3);
    while (smooth.work()) {
    }
    return smooth.found();
  }
  double least(const Path& path, const Scene& scene) const {
    Kinematics kinematics(model);
    WholeConfiguration c;
    double least = 1e9;
    for (double t = 0.0; t < path.duration + 0.01; t += 0.01) {
      path.at(t, c);
      kinematics.update(c.head<3>(), c.tail(model->num_joints()));
      least = std::min(least, object_clearance(*model, kinematics, scene));
    }
    return least;
  }

  std::shared_ptr<const RobotModel> model;
  ControllerParams params;
  MotionLimits limits;
  FreeSpace space;
  WholeBodyIk ik;
  SmoothPath smooth;
};

INSTANTIATE_TEST_SUITE_P(Robots, Smooth,
                         testing::Values("configs/robots/frankie.yaml", "configs/robots/frankie_omni.yaml",
                                         "configs/robots/lift_ur5.yaml"),
                         [](const auto& param) { return test_name(param.param); });

TEST_P(Smooth, IsQuickerThanEdgesAndKeepsTheLimits) {
  std::mt19937_64 engine(1);
  Kinematics kinematics(model);
  double edges = 0.0, smooths = 0.0;
  int found = 0;
  constexpr int kPaths = 20;
  for (std::uint64_t seed = 0; seed < kPaths; ++seed) {
    const std::vector<WholeConfiguration> corners = drawn(engine);
    put({}, corners.front(), 0.0);
    if (!run(corners)) continue;
    ++found;
    const Path& path = smooth.path();
    edges += time_of_edges(corners);
    smooths += path.duration;
    kinematics.update(corners.back().head<3>(), corners.back().tail(model->num_joints()));
    const Isometry X_WE = kinematics.X_WE();
    WholeConfiguration c, before, after;
    path.at(0.0, c);
    EXPECT_EQ((c - corners.front()).norm(), 0.0);
    path.at(path.duration, c);
    kinematics.update(c.head<3>(), c.tail(model->num_joints()));
    EXPECT_LT((kinematics.X_WE().translation() - X_WE.translation()).norm(), 1e-3) << "seed " << seed;
    // The part of a motion that is spread over the whole time may exceed the path's share of the robot's limits, never
    // the limits.
    const double fast = 1.0 / params.plan.speed, quick = 1.0 / params.plan.acceleration;
    const Extremes most = extremes(path);
    for (int i = 0; i < limits.num_joints(); ++i) {
      EXPECT_LE(most.speed[3 + i], fast * limits.joint_speed[i]) << "joint " << i << ", seed " << seed;
      EXPECT_LE(most.acceleration[3 + i], quick * limits.joint_acceleration[i]) << "joint " << i << ", seed " << seed;
    }
    EXPECT_LE(most.speed[2], fast * limits.angular) << "seed " << seed;
    EXPECT_LE(most.acceleration[2], quick * limits.angular_acceleration) << "seed " << seed;
    EXPECT_LE(most.speed.head<2>().maxCoeff(), fast * limits.linear) << "seed " << seed;
    if (!limits.base->nonholonomic()) continue;
    for (double t = 0.0; t < path.duration; t += 0.01) {
      path.at(t - 0.005, before);
      path.at(t + 0.005, after);
      const double heading = 0.5 * (before[2] + after[2]);
      const Vector2 v = (after - before).head<2>() / 0.01;
      EXPECT_LT(std::abs(std::cos(heading) * v.y() - std::sin(heading) * v.x()), 0.1) << "sideways at " << t;
    }
  }
  EXPECT_GE(found, kPaths - 2);
  EXPECT_LT(smooths, 0.75 * edges);
}

TEST_P(Smooth, BeginsAtTheVelocityOfItsBraking) {
  std::mt19937_64 engine(2);
  std::vector<WholeConfiguration> corners = drawn(engine);
  Braking braking{corners.front(), 0.3};
  const double v = 0.4;
  braking.from.head<2>() -= 0.5 * v * braking.time * Vector2(std::cos(corners[0][2]), std::sin(corners[0][2]));
  braking.from[3] -= 0.02;
  put({}, corners.front(), 0.0);
  ASSERT_TRUE(run(corners, braking));
  WholeConfiguration c;
  smooth.path().at(0.0, c);
  EXPECT_EQ((c - braking.from).norm(), 0.0);
  smooth.path().at(0.001, c);
  const WholeConfiguration wanted = 2.0 / braking.time * (corners.front() - braking.from);
  EXPECT_LT(((c - braking.from) / 0.001 - wanted).norm(), 0.02);
}

// Posts that the edges clear and the first motion does not: the robot passes the corners later, and takes longer unless
// it moves them.
TEST_P(Smooth, PassesCornersLaterWhereThatIsNotFree) {
  const double moves = std::exchange(params.plan.smooth.moves, 0.0);
  Scene scene;
  std::vector<WholeConfiguration> corners = tucked(4);
  corners[1].head<2>() << 2.5, 0.0;
  corners[2].head<2>() << 1.5, 2.0;
  corners[3].head<2>() << 3.5, 2.5;
  put(scene, corners[0], 0.0);
  ASSERT_TRUE(run(corners));
  const Path without = smooth.path();
  scene.shapes = {{"post", make_cylinder(0.05, 1.0)}};
  scene.states.resize(1);
  Edge edge;
  int posts = 0, found = 0;
  for (int k = 0; k < 225; ++k) {
    scene.states[0].X_WO.translation() << 0.5 + 0.2 * (k % 15), -0.5 + 0.2 * (k / 15), 0.5;
    if (least(without, scene) > 0.01) continue;
    put(scene, corners[0], 0.05);
    bool free = true;
    for (std::size_t i = 0; free && i + 1 < corners.size(); ++i) {
      make_edge(limits, corners[i], corners[i + 1], edge);
      free = space.free(edge, 0.02);
    }
    if (!free) continue;
    ++posts;
    put(scene, corners[0], 0.03);
    if (!run(corners)) continue;
    ++found;
    EXPECT_GT(least(smooth.path(), scene), 0.02) << "post " << k;
    EXPECT_GT(smooth.path().duration, without.duration) << "post " << k;
    EXPECT_LT(smooth.path().duration, 1.01 * time_of_edges(corners)) << "post " << k;
    params.plan.smooth.moves = moves;
    EXPECT_TRUE(run(corners)) << "post " << k;
    EXPECT_GT(least(smooth.path(), scene), 0.02) << "post " << k;
    params.plan.smooth.moves = 0.0;
  }
  EXPECT_GT(posts, 1);
  EXPECT_EQ(found, posts);
}

// A corner far beyond the end of a wall, that cannot be left out, moves to the wall's end.
TEST_P(Smooth, MovesACornerThatIsFartherOffThanItHasToBe) {
  const Scene scene = wall();
  std::vector<WholeConfiguration> corners = tucked(3);
  corners[1].head<2>() << 1.5, -4.0;
  corners[2].head<2>() << 3.0, 0.0;
  put(scene, corners[0], 0.03);
  const auto farthest = [&] {
    EXPECT_TRUE(run(corners));
    EXPECT_GT(least(smooth.path(), scene), 0.02);
    WholeConfiguration c;
    double beside = 0.0;
    for (double t = 0.0; t < smooth.path().duration; t += 0.01) {
      smooth.path().at(t, c);
      beside = std::min(beside, c[1]);
    }
    return beside;
  };
  params.plan.smooth.moves = 0.0;
  EXPECT_LT(farthest(), -3.0);
  const double unmoved = smooth.path().duration;
  params.plan.smooth.moves = 0.8;
  EXPECT_GT(farthest(), -2.8);
  EXPECT_LT(smooth.path().duration, 0.85 * unmoved);
}

// The shortest way round a wall for a point is shorter than a route, but not by much.
TEST_P(Smooth, RoutesGoTheShortWayRoundAWall) {
  const Scene scene = wall();
  WholeConfiguration start = WholeConfiguration::Zero(3 + model->num_joints());
  start.tail(model->num_joints()) = model->ready;
  std::vector<GoalConfiguration> goals(2);
  goals[0].c = goals[1].c = start;
  goals[0].c.head<2>() << 3.0, 0.0;
  goals[1].c.head<2>() << 6.0, 0.0;  // outside of the box
  const VectorX tuck = tucked_arm(*model, space, {-1.0, 0.0, 0.0});
  put(scene, start, 0.03);
  Route route(limits, params.plan);
  route.begin(start, goals, tuck, Vector2(-2.0, -3.0), Vector2(4.0, 3.0));
  Progress progress = Progress::kMore;
  const auto advance = [&] {
    do progress = route.advance(space);
    while (progress == Progress::kMore);
    return progress;
  };
  ASSERT_EQ(advance(), Progress::kFound);
  double way = 0.0, beside = 0.0;
  const auto corners = route.corners();
  for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
    way += (corners[k + 1] - corners[k]).head<2>().norm();
    beside = std::min(beside, corners[k + 1][1]);
    if (k == 0) continue;
    EXPECT_EQ((corners[k].tail(model->num_joints()) - tuck).norm(), 0.0);
    EXPECT_TRUE(space.free(corners[k])) << "corner " << k;
  }
  EXPECT_EQ((corners.front() - start).norm(), 0.0);
  EXPECT_LT((corners.back() - goals[0].c).head<2>().norm(), 1e-9);
  EXPECT_LT(beside, -1.1) << "round the nearer end";
  const double point = std::hypot(1.4, 1.1) + 0.2 + std::hypot(1.4, 1.1);
  EXPECT_GT(way, point);
  EXPECT_LT(way, point + 1.3);
  EXPECT_EQ(advance(), Progress::kNone);
}

}  // namespace
}  // namespace moma::test
