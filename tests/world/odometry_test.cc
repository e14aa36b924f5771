// Dead reckoning, detection and the drives: each error alone against its definition, worked out here in another way.
#include "world/sensing/sensing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/no_alloc.h"
#include "tests/support/tiny_robot.h"
#include "tests/world/support.h"
#include "world/sensing/actuation.h"
#include "world/sensing/detection.h"

namespace moma::test {
namespace {

World numbered(std::uint64_t index) {
  World world;
  world.seed = 9;
  world.index = index;
  return world;
}

// The reckoned pose after driving `way` metres at constant curvature [rad/m] from a given start, in steps of 1 cm.
Vector3 drive(const OdometryErrors& errors, std::uint64_t index, double way, double curvature,
              const Vector3& start = Vector3::Zero()) {
  Odometry odometry(errors, DisturbanceStreams(numbered(index), 0));
  const long steps = std::lround(way / 0.01);
  Vector3 reckoned = start;
  for (long k = 0; k <= steps; ++k) {
    const double s = 0.01 * static_cast<double>(k), a = curvature * s;
    // Exact arc in the start's frame.
    const double x = curvature == 0.0 ? s : std::sin(a) / curvature,
                 y = curvature == 0.0 ? 0.0 : (1.0 - std::cos(a)) / curvature;
    const double c = std::cos(start.z()), n = std::sin(start.z());
    reckoned = odometry.update(k, {start.x() + c * x - n * y, start.y() + n * x + c * y, start.z() + a});
  }
  return reckoned;
}

double deviation(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double v : x) sum += v * v;
  return std::sqrt(sum / static_cast<double>(x.size()));
}

TEST(Odometry, WithoutErrorsAddsUpToTheTruth) {
  OdometryErrors tiny;
  tiny.distance = 1e-300;
  const Vector3 start(1.0, 2.0, 0.7);
  const Vector3 end = drive(tiny, 0, 5.0, 0.8, start);
  const double a = 0.8 * 5.0, x = std::sin(a) / 0.8, y = (1 - std::cos(a)) / 0.8;
  EXPECT_NEAR(end.x(), 1.0 + std::cos(0.7) * x - std::sin(0.7) * y, 1e-12);
  EXPECT_NEAR(end.y(), 2.0 + std::sin(0.7) * x + std::cos(0.7) * y, 1e-12);
  EXPECT_NEAR(end.z(), 0.7 + a, 1e-12);
}

TEST(Odometry, SystematicErrorsGrowWithTheWay) {
  OdometryErrors distance, turn, heading;
  distance.distance = 0.02;
  turn.turn = 0.03;
  heading.heading = 0.01;
  std::vector<double> by_distance, by_turn, by_heading;
  for (std::uint64_t world = 0; world < 800; ++world) {
    const double two = drive(distance, world, 2.0, 0.0).x() - 2.0, four = drive(distance, world, 4.0, 0.0).x() - 4.0;
    ASSERT_NEAR(four, 2.0 * two, 1e-12) << "proportional to the way";
    by_distance.push_back(two / 2.0);
    // A turn of 2 rad is measured (1 + e) times as large, and so is one of 4 rad.
    const double half = drive(turn, world, 2.0, 1.0).z() - 2.0, whole = drive(turn, world, 4.0, 1.0).z() - 4.0;
    ASSERT_NEAR(whole, 2.0 * half, 1e-12);
    ASSERT_NEAR(drive(turn, world, 2.0, 0.0).z(), 0.0, 0.0) << "straight on there is no turn to mistake";
    by_turn.push_back(half / 2.0);
    // Driving straight on looks like an arc of curvature e: end point of the arc.
    const Vector3 end = drive(heading, world, 3.0, 0.0);
    const double e = end.z() / 3.0;
    by_heading.push_back(e);
    ASSERT_NEAR(end.x(), std::sin(3.0 * e) / e, 1e-6);
    ASSERT_NEAR(end.y(), (1.0 - std::cos(3.0 * e)) / e, 1e-6);
  }
  const double five = 5.0 / std::sqrt(2.0 * 800.0);  // five deviations of an estimated deviation
  EXPECT_NEAR(deviation(by_distance), 0.02, 0.02 * five);
  EXPECT_NEAR(deviation(by_turn), 0.03, 0.03 * five);
  EXPECT_NEAR(deviation(by_heading), 0.01, 0.01 * five);
}

TEST(Odometry, TheRandomWalksVarianceIsProportionalToTheWay) {
  OdometryErrors position, rotation;
  position.walk.position = 0.01;
  rotation.walk.rotation = 0.02;
  for (const double way : {1.0, 4.0}) {
    std::vector<double> along, across, turned;
    for (std::uint64_t world = 0; world < 800; ++world) {
      const Vector3 end = drive(position, world, way, 0.0);
      along.push_back(end.x() - way);
      across.push_back(end.y());
      turned.push_back(drive(rotation, world, way, 0.0).z());
    }
    const double five = 5.0 / std::sqrt(2.0 * 800.0);
    EXPECT_NEAR(deviation(along), 0.01 * std::sqrt(way), 0.01 * std::sqrt(way) * five) << way;
    EXPECT_NEAR(deviation(across), 0.01 * std::sqrt(way), 0.01 * std::sqrt(way) * five) << way;
    EXPECT_NEAR(deviation(turned), 0.02 * std::sqrt(way), 0.02 * std::sqrt(way) * five) << way;
  }
}

TEST(Odometry, AtRestNothingDrifts) {
  OdometryErrors all{0.1, 0.1, 0.1, {0.1, 0.1}};
  Odometry odometry(all, DisturbanceStreams(numbered(0), 0));
  const Vector3 pose(1, 2, 3);
  for (long k = 0; k < 1000; ++k) ASSERT_EQ(odometry.update(k, pose), pose);
}

// Base driving along x towards objects at rest; what is visible at each step.
std::vector<std::vector<bool>> visible(const DetectionRule& rule, const std::vector<WorldObject>& solids,
                                       const std::vector<double>& x) {
  World world;
  world.objects = solids;
  Detection detection(rule, world, DisturbanceStreams(world, 0), 0.02);
  std::vector<std::vector<bool>> out;
  for (const double at : x) {
    std::vector<ObjectState> states(solids.size());
    object_states(world, 0.0, states);
    detection.update(static_cast<long>(out.size()), {at, 0.0, 0.0}, {}, states);
    auto& now = out.emplace_back();
    for (const ObjectState& state : states) now.push_back(state.visible);
  }
  return out;
}

TEST(Detection, RangeHidesObjectsAndRevealsEachOnce) {
  // A ball and a long wall ahead of the way, whose centre is far to the side: its surface counts.
  const std::vector<WorldObject> solids = {
      solid("ball", ShapeKind::kSphere, {0.2, 0, 0}, {3.0, 0.0, 0.5}),
      solid("wall", ShapeKind::kBox, {0.2, 10.0, 2.0}, {5.0, 4.9, 0.5}),
  };
  std::vector<double> x;
  for (int i = 0; i <= 100; ++i) x.push_back(0.025 * i);  // to 2.5 m
  for (int i = 100; i >= 0; --i) x.push_back(0.025 * i);  // and back
  DetectionRule rule;
  rule.range = 1.0;
  const auto seen = visible(rule, solids, x);
  int first_ball = -1, first_wall = -1;
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (seen[k][0] && first_ball < 0) first_ball = static_cast<int>(k);
    if (seen[k][1] && first_wall < 0) first_wall = static_cast<int>(k);
    if (first_ball >= 0) {
      ASSERT_TRUE(seen[k][0]) << "found once, known to the end";
    }
  }
  EXPECT_EQ(first_ball, 72) << "x = 1.8: 1 m from the ball's surface";
  EXPECT_EQ(first_wall, -1) << "the wall's face is at 4.9, 2.4 m from the furthest point";
  rule.range = 2.5;
  const auto further = visible(rule, solids, x);
  for (std::size_t k = 0; k < further.size(); ++k)
    ASSERT_EQ(further[k][1], k >= 96) << "x = 2.4: 2.5 m from the wall's face, step " << k;
}

TEST(Detection, TakesItsTimeAndStartsAgainWhenTheObjectLeaves) {
  const std::vector<WorldObject> solids = {solid("ball", ShapeKind::kSphere, {0.2, 0, 0}, {2.0, 0.0, 0.5})};
  DetectionRule rule;
  rule.range = 1.0;
  rule.detection = 0.1;                           // 5 steps
  std::vector<double> x(5, 0.9);                  // steps 0 to 4: seen for 4 periods only
  x.push_back(0.0);                               // step 5: out of range
  for (int i = 0; i < 10; ++i) x.push_back(0.9);  // from step 6 on in range again: found at step 11
  const auto seen = visible(rule, solids, x);
  for (std::size_t k = 0; k < seen.size(); ++k) ASSERT_EQ(seen[k][0], k >= 11) << k;
  rule.range = std::numeric_limits<double>::infinity();
  const auto late = visible(rule, solids, x);
  for (std::size_t k = 0; k < late.size(); ++k) ASSERT_EQ(late[k][0], k >= 5) << k;
  // Known at the start: at once what is in range then, and nothing else.
  rule.known_at_start = true;
  rule.range = 1.0;
  const auto known = visible(rule, solids, x);
  for (std::size_t k = 0; k < known.size(); ++k) ASSERT_TRUE(known[k][0]) << k;
  const auto from_afar = visible(rule, solids, std::vector<double>{0.0, 0.9, 0.9, 0.9, 0.9, 0.9, 0.9, 0.9});
  for (std::size_t k = 0; k < from_afar.size(); ++k) ASSERT_EQ(from_afar[k][0], k >= 6) << k;
}

TEST(Actuation, DelaysInStepsAndScalesByAConstantFactor) {
  const auto model = tiny_robot();
  Disturbances d;
  d.actuators.joints.delay = 0.04;  // 2 steps
  d.actuators.base.delay = 0.1;     // 5
  d.actuators.joints.gain_error = 0.05;
  d.actuators.base.gain_error = {0.1, 0.2};
  std::vector<double> joint, linear, angular;
  for (std::uint64_t world = 0; world < 800; ++world) {
    Actuation actuation(d, *model, numbered(world), 0.02);
    VectorX factor = VectorX::Constant(5, std::nan(""));
    for (long k = 0; k < 12; ++k) {
      const double c = 1.0 + static_cast<double>(k);
      const VectorX applied = actuation.act(k, VectorX::Constant(5, c));
      const VectorX base = applied.head(2);
      // Nothing moves before the first command, which is 1, is due.
      if (k == 5) factor.head(2) = applied.head(2);
      if (k == 2) factor.tail(3) = applied.tail(3);
      const VectorX base_expected = k < 5 ? VectorX::Zero(2) : VectorX(factor.head(2) * (c - 5.0));
      const VectorX joints_expected = k < 2 ? VectorX::Zero(3) : VectorX(factor.tail(3) * (c - 2.0));
      ASSERT_EQ(base, base_expected) << k;
      ASSERT_EQ(applied.tail(3), joints_expected) << k;
    }
    linear.push_back(factor[0] - 1.0);
    angular.push_back(factor[1] - 1.0);
    joint.push_back(factor[3] - 1.0);
    ASSERT_NE(factor[2], factor[3]);
  }
  const double five = 5.0 / std::sqrt(2.0 * 800.0);
  EXPECT_NEAR(deviation(linear), 0.1, 0.1 * five);
  EXPECT_NEAR(deviation(angular), 0.2, 0.2 * five);
  EXPECT_NEAR(deviation(joint), 0.05, 0.05 * five);
}

TEST(Actuation, NeverTurnsACommandRound) {
  const auto model = tiny_robot();
  Disturbances d;
  d.actuators.joints.gain_error = 1.0;
  int stopped = 0;
  for (std::uint64_t world = 0; world < 200; ++world) {
    Actuation actuation(d, *model, numbered(world), 0.02);
    const VectorX applied = actuation.act(0, VectorX::Ones(5));
    EXPECT_GE(applied.minCoeff(), 0.0);
    stopped += applied.minCoeff() == 0.0;
  }
  EXPECT_GT(stopped, 0);
}

TEST(Actuation, MovesThePlantAsMuch) {
  // Both plants: one second of a constant command, late by 0.2 s, with a gain's error.
  const auto model = robot("frankie");
  World world = empty_world(*model);
  world.seed = 3;
  Disturbances d;
  d.actuators.joints.delay = 0.2;
  d.actuators.joints.gain_error = 0.05;
  d.actuators.base = {0.2, {0.1, 0.1}};
  for (const SimulationMode mode : {SimulationMode::kKinematic, SimulationMode::kDynamic}) {
    SimulationConfig simulation;
    simulation.mode = mode;
    const auto plant = make_plant(model, world, simulation);
    Actuation actuation(d, *model, world, 0.02);
    VectorX command = VectorX::Zero(model->num_velocities());
    command[0] = 0.3;
    command[2] = 0.2;
    PlantReport report;
    plant->check_start(report);
    VectorX applied;
    for (long k = 0; k < 60; ++k) {
      applied = actuation.act(k, command);
      plant->advance(applied, 0.02, report);
    }
    ASSERT_NE(applied[0], command[0]);
    // The dynamic base takes 0.15 s to reach 0.3 m/s at 2 m/s^2, which costs 0.3^2 / (2 * 2) m.
    const bool dynamic = mode == SimulationMode::kDynamic;
    const double ramp = dynamic ? applied[0] * applied[0] / 4.0 : 0.0;
    EXPECT_NEAR(plant->state().base.x(), applied[0] * 1.0 - ramp, dynamic ? 2e-3 : 1e-12) << to_string(mode);
    EXPECT_NEAR(plant->state().q[0] - model->ready[0], applied[2] * 1.0, dynamic ? 2e-3 : 1e-12) << to_string(mode);
  }
}

TEST(Actuation, AllocatesNothing) {
  if (!NoAlloc::works()) GTEST_SKIP() << "malloc is another's here";
  const auto model = tiny_robot();
  Disturbances d;
  d.actuators.joints.delay = 0.04;
  d.actuators.joints.gain_error = 0.1;
  d.actuators.base = {0.1, {0.1, 0.1}};
  Actuation actuation(d, *model, numbered(0), 0.02);
  const VectorX command = VectorX::Ones(5);
  const NoAlloc guard;
  for (long k = 0; k < 100; ++k) actuation.act(k, command);
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace moma::test
