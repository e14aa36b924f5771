// What goes wrong now and then: late and lost measurements and commands, slipping wheels, coarse encoders, objects that
// are out of view, hidden, missed or not there, and bases whose drives do not do as they are told.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "tests/support/control_period.h"
#include "tests/world/sensing_support.h"
#include "tests/world/support.h"
#include "world/sensing/actuation.h"
#include "world/sensing/delay_line.h"

namespace moma::test {
namespace {

// What a line hands out, worked out from the whole past at each step.
TEST(DelayLine, HandsOutTheNewestThatHasArrived) {
  for (const long steps : {0L, 1L, 3L}) {
    for (const long jitter : {0L, 2L, 5L}) {
      for (const BeforeFirst before : {BeforeFirst::kHoldFirst, BeforeFirst::kPrototype}) {
        DelayLine<double> line(steps, -1.0, before, jitter);
        std::vector<long> due;
        for (long k = 0; k < 500; ++k) {
          Draws draws(9, 0, Stream::kSensing, static_cast<std::uint64_t>(k));
          const long more = arrival({0.1, 0.3}, jitter, draws);
          ASSERT_TRUE(more == DelayLine<double>::kLost || (more >= 0 && more <= jitter)) << more;
          due.push_back(more == DelayLine<double>::kLost ? 1000000 : k + steps + more);
          double value = 100.0 + static_cast<double>(k);
          line.pass(k, value, more);
          double expected = before == BeforeFirst::kHoldFirst ? 100.0 : -1.0;
          for (long made = 0; made <= k; ++made)
            if (due[static_cast<std::size_t>(made)] <= k) expected = 100.0 + static_cast<double>(made);
          ASSERT_EQ(value, expected) << "step " << k << " steps " << steps << " jitter " << jitter;
        }
      }
    }
  }
}

TEST(DelayLine, WithoutJitterAndLossesHandsOutTheValueOfSoManyStepsBefore) {
  for (const long steps : {0L, 2L}) {
    DelayLine<double> holds(steps, -1.0, BeforeFirst::kHoldFirst), plain(steps, -1.0, BeforeFirst::kPrototype);
    const auto made = [](long k) { return std::sin(static_cast<double>(k)); };
    for (long k = 0; k < 50; ++k) {
      double a = made(k), b = a;
      holds.pass(k, a);
      plain.pass(k, b);
      ASSERT_EQ(a, made(std::max(0L, k - steps))) << k;
      ASSERT_EQ(b, k < steps ? -1.0 : made(k - steps)) << k;
    }
  }
}

TEST(Arrival, IsEvenAndLosesAsOftenAsItSays) {
  std::map<long, int> counts;
  constexpr int kDraws = 20000;
  for (int k = 0; k < kDraws; ++k)
    ++counts[arrival({0.06, 0.2}, 3, Draws(1, 2, Stream::kSensing, static_cast<std::uint64_t>(k)))];
  EXPECT_EQ(counts.size(), 5u);
  // Five standard deviations of a binomial count.
  const auto near = [&](long at, double p) {
    EXPECT_NEAR(counts[at], p * kDraws, 5.0 * std::sqrt(kDraws * p * (1.0 - p))) << at;
  };
  near(-1, 0.2);
  for (const long more : {0L, 1L, 2L, 3L}) near(more, 0.2);
}

// Every part by its own stream: the others stay what they are.
TEST(Sensing, WhatArrivesLateIsAMeasurementOfThen) {
  const auto parts = [](Disturbances& d) {
    return std::vector<std::pair<Irregularity*, double*>>{{&d.joints.irregularity, &d.joints.delay},
                                                          {&d.base.irregularity, &d.base.delay},
                                                          {&d.objects.irregularity, &d.objects.delay},
                                                          {&d.goal.irregularity, &d.goal.delay}};
  };
  for (std::size_t part = 0; part < 4; ++part) {
    Disturbances d;
    parts(d)[part].first->jitter = 0.06;
    parts(d)[part].first->dropout = 0.1;
    *parts(d)[part].second = 0.04;
    SensingRig rig(d);
    std::set<long> ages;
    for (long k = 0; k < 400; ++k) {
      const Observation seen = rig.sense(k);
      const Observation now = rig.truth(k);
      long age = -1;
      for (long back = 0; back <= k && age < 0; ++back) {
        const Observation then = rig.truth(k - back);
        const bool same = part == 0   ? seen.q == then.q && seen.qdot.tail(3) == then.qdot.tail(3)
                          : part == 1 ? seen.base == then.base
                          : part == 2 ? seen.objects[1].X_WO.translation() == then.objects[1].X_WO.translation()
                                      : seen.goal.X_WG.translation() == then.goal.X_WG.translation();
        if (same) age = back;
      }
      ASSERT_GE(age, 0) << "step " << k << ": what is seen was never there, part " << part;
      if (k > 20) {
        EXPECT_GE(age, 2) << part;
        ages.insert(age);
      }
      if (k <= 20) continue;
      EXPECT_EQ(part == 0, seen.q != now.q) << part << " at " << k;
      EXPECT_EQ(part == 1, seen.base != now.base) << part << " at " << k;
    }
    EXPECT_GE(ages.size(), 3u) << "lateness does not vary, part " << part;
  }
}

TEST(Sensing, EncodersAreAsCoarseAsTheySay) {
  Disturbances d;
  d.joints.resolution = 0.01;
  d.joints.velocity_resolution = 0.05;
  d.base.velocity_resolution = {0.02, 0.03};
  SensingRig rig(d);
  std::set<double> values_seen;
  for (long k = 0; k < 200; ++k) {
    const Observation seen = rig.sense(k), truth = rig.truth(k);
    const auto check = [k](double is, double was, double step) {
      EXPECT_NEAR(is / step, std::round(is / step), 1e-9) << k;
      EXPECT_LE(std::abs(is - was), 0.5 * step + 1e-12) << k;
    };
    for (Eigen::Index i = 0; i < 3; ++i) check(seen.q[i], truth.q[i], 0.01);
    for (Eigen::Index i = 2; i < 5; ++i) check(seen.qdot[i], truth.qdot[i], 0.05);
    check(seen.qdot[0], truth.qdot[0], 0.02);
    check(seen.qdot[1], truth.qdot[1], 0.03);
    values_seen.insert(seen.q[0]);
    EXPECT_EQ(seen.base, truth.base);
  }
  EXPECT_GT(values_seen.size(), 3u);
}

TEST(Sensing, NoiseGrowsWithTheSquareOfTheDistance) {
  Disturbances d;
  d.objects.noise.position = 0.01;
  d.objects.noise_growth = 0.5;
  const Disturbances plain = [&] {
    Disturbances out = d;
    out.objects.noise_growth = 0.0;
    return out;
  }();
  SensingRig rig(d, 0, 3), other(plain, 0, 3);
  for (long k = 0; k < 50; ++k) {
    const Observation truth = rig.truth(k), near = other.sense(k), far = rig.sense(k);
    const Vector3 sensor(truth.base.x(), truth.base.y(), 0.5);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3& p = truth.objects[i].X_WO.translation();
      const double factor = 1.0 + 0.5 * (p - sensor).squaredNorm();
      const Vector3 expected = factor * (near.objects[i].X_WO.translation() - p);
      EXPECT_LT((far.objects[i].X_WO.translation() - p - expected).norm(), 1e-12) << i;
    }
  }
}

TEST(Odometry, SlipsAsOftenAndAsFarAsItSays) {
  World world;
  world.seed = 3;
  OdometryErrors errors;
  errors.slip = {2.0, 0.05, 0.0};
  Odometry odometry(errors, DisturbanceStreams(world, 0));
  ASSERT_TRUE(odometry.on());
  constexpr long kSteps = 20000;
  constexpr double kInterval = 0.01;
  double last = 0.0, squares = 0.0;
  int slips = 0;
  for (long k = 0; k <= kSteps; ++k) {
    const Vector3 seen = odometry.update(k, {kInterval * static_cast<double>(k), 0.0, 0.0});
    EXPECT_EQ(seen.y(), 0.0);
    EXPECT_EQ(seen.z(), 0.0);
    if (k > 0 && std::abs(seen.x() - last - kInterval) > 1e-9) {
      ++slips;
      squares += (seen.x() - last - kInterval) * (seen.x() - last - kInterval);
    }
    last = seen.x();
  }
  const double p = 1.0 - std::exp(-2.0 * kInterval), expected = p * kSteps;
  EXPECT_NEAR(slips, expected, 5.0 * std::sqrt(expected * (1.0 - p)));
  EXPECT_NEAR(std::sqrt(squares / slips), 0.05, 5.0 * 0.05 / std::sqrt(2.0 * slips));
}

// Of each object, whether it is seen, at one state of the tiny robot.
class Eyes {
 public:
  Eyes(const DetectionRule& rule, std::vector<WorldObject> objects) : objects_(std::move(objects)) {
    World world;
    world.objects = objects_;
    world.seed = 8;
    detection_.emplace(rule, world, DisturbanceStreams(world, 0), kPeriod, tiny_robot());
  }
  std::vector<bool> look(const Vector3& base, const VectorX& q = VectorX::Zero(3)) {
    World world;
    world.objects = objects_;
    std::vector<ObjectState> states(objects_.size());
    object_states(world, 0.0, states);
    detection_->update(k_++, base, q, states);
    std::vector<bool> out;
    for (const ObjectState& state : states) out.push_back(state.visible);
    return out;
  }

 private:
  std::vector<WorldObject> objects_;
  std::optional<Detection> detection_;
  long k_ = 0;
};

TEST(Detection, SeesWhatIsInTheConeOfItsCamera) {
  const std::vector<WorldObject> around = {solid("ahead", ShapeKind::kSphere, {0.1, 0, 0}, {3, 0, 0.5}),
                                           solid("left", ShapeKind::kSphere, {0.1, 0, 0}, {0, 3, 0.5}),
                                           solid("behind", ShapeKind::kSphere, {0.1, 0, 0}, {-3, 0, 0.5}),
                                           solid("edge", ShapeKind::kSphere, {0.1, 0, 0}, {3, 2.9, 0.5})};
  DetectionRule rule;
  rule.field_of_view = 1.57;  // 45 degrees to each side
  EXPECT_EQ(Eyes(rule, around).look({0, 0, 0}), (std::vector<bool>{true, false, false, true}));
  EXPECT_EQ(Eyes(rule, around).look({0, 0, 1.5708}), (std::vector<bool>{false, true, false, false}));
  rule.axis = {-1, 0, 0};
  EXPECT_EQ(Eyes(rule, around).look({0, 0, 0}), (std::vector<bool>{false, false, true, false}));
  // On the hand: the arm's first joint turns it.
  rule.axis = {1, 0, 0};
  rule.mount = SensorMount::kHand;
  rule.sensor = {0, 0, 0};
  EXPECT_EQ(Eyes(rule, around).look({0, 0, 0}), (std::vector<bool>{true, false, false, false}));
  EXPECT_EQ(Eyes(rule, around).look({0, 0, 0}, Vector3(1.5708, 0, 0)), (std::vector<bool>{false, true, false, false}));
}

TEST(Detection, WhatStandsBeforeSomethingHidesIt) {
  // A wall, a ball behind it, and one beside.
  const std::vector<WorldObject> scene = {solid("wall", ShapeKind::kBox, {0.1, 1.0, 2.0}, {2, 0, 0.5}),
                                          solid("hidden", ShapeKind::kSphere, {0.2, 0, 0}, {4, 0, 0.5}),
                                          solid("beside", ShapeKind::kSphere, {0.2, 0, 0}, {4, 2, 0.5}),
                                          solid("pole", ShapeKind::kCylinder, {0.05, 2.0, 0}, {-2, 0, 0.5}),
                                          solid("shadow", ShapeKind::kSphere, {0.02, 0, 0}, {-3, 0, 0.5})};
  DetectionRule rule;
  rule.occlusion = true;
  rule.sensor = {0, 0, 1.0};
  EXPECT_EQ(Eyes(rule, scene).look({0, 0, 0}), (std::vector<bool>{true, false, true, true, false}));
  EXPECT_EQ(Eyes(rule, scene).look({0, 2, 0}), (std::vector<bool>{true, true, true, true, true}));
  // The robot's own arm: its ball of 5 cm at the elbow is on the way to what is small and straight ahead.
  rule.sensor = {-0.5, 0, 0.5};
  const std::vector<WorldObject> small = {solid("small", ShapeKind::kSphere, {0.02, 0, 0}, {4, 0, 0.5})};
  EXPECT_FALSE(Eyes(rule, small).look({0, 0, 0})[0]);
  rule.sensor = {-0.5, 0, 1.0};
  EXPECT_TRUE(Eyes(rule, small).look({0, 0, 0})[0]);
}

TEST(Detection, BySensorsSeesWhatTheirRaysEndOnNow) {
  auto model = std::make_shared<RobotModel>(*tiny_robot());
  Sensor ahead;
  ahead.name = "ahead";
  ahead.rate = 25.0;  // every second step
  model->sensors.push_back({ahead, 0, Isometry(Eigen::Translation3d(0, 0, 1.0))});
  DetectionRule rule;
  rule.seen_by = SeenBy::kSensors;
  rule.range = 0.1;  // of the rule, which does not count
  World world;
  world.objects = {solid("ball", ShapeKind::kSphere, {0.1, 0, 0}, {2, 0, 1.0}),
                   solid("behind", ShapeKind::kSphere, {0.1, 0, 0}, {-2, 0, 1.0}),
                   solid("speck", ShapeKind::kSphere, {0.003, 0, 0}, {2, 0.5, 1.0})};
  Detection detection(rule, world, DisturbanceStreams(world, 0), kPeriod, model);
  ASSERT_TRUE(detection.on());
  const auto seen = [&](long k, const Vector3& base) {
    std::vector<ObjectState> states(3);
    object_states(world, 0.0, states);
    detection.update(k, base, VectorX::Zero(3), states);
    return std::vector<bool>{states[0].visible, states[1].visible, states[2].visible};
  };
  EXPECT_EQ(seen(0, {0, 0, 0}), (std::vector<bool>{true, false, false})) << "a speck is not hit by two rays";
  EXPECT_EQ(seen(1, {0, 0, 3.14}), (std::vector<bool>{true, false, false})) << "the next frame is not due";
  EXPECT_EQ(seen(2, {0, 0, 3.14}), (std::vector<bool>{false, true, false})) << "out of view, no longer told of";
  EXPECT_EQ(detection.sensor_W({0, 0, 0}), Vector3(0, 0, 1.0));
}

TEST(Detection, KnowsWhatItFoundToTheEndUnlessItIsLost) {
  const std::vector<WorldObject> ball = {solid("ball", ShapeKind::kSphere, {0.1, 0, 0}, {3, 0, 0.5})};
  for (const bool lost : {false, true}) {
    DetectionRule rule;
    rule.field_of_view = 1.0;
    rule.detection = 0.04;
    rule.lost = lost;
    Eyes eyes(rule, ball);
    EXPECT_FALSE(eyes.look({0, 0, 0})[0]);
    EXPECT_FALSE(eyes.look({0, 0, 0})[0]);
    EXPECT_TRUE(eyes.look({0, 0, 0})[0]);
    EXPECT_EQ(eyes.look({0, 0, 3.0})[0], !lost);
    EXPECT_TRUE(eyes.look({0, 0, 0})[0]) << "found again at once";
  }
}

TEST(Detection, MissesObjectsForSpansOfTime) {
  std::vector<WorldObject> many;
  for (int i = 0; i < 20; ++i)
    many.push_back(solid("o" + std::to_string(i), ShapeKind::kSphere, {0.1, 0, 0}, {3, 0, 0}));
  DetectionRule rule;
  rule.missed = {0.3, 0.1};
  Eyes eyes(rule, many);
  int unseen = 0;
  std::vector<bool> last;
  constexpr int kSpans = 100;
  for (int k = 0; k < 5 * kSpans; ++k) {
    const std::vector<bool> now = eyes.look({0, 0, 0});
    if (k % 5 != 0) {
      EXPECT_EQ(now, last) << "changes within a span, step " << k;
    }
    if (k % 5 == 0) unseen += static_cast<int>(std::count(now.begin(), now.end(), false));
    last = now;
  }
  EXPECT_NEAR(unseen, 0.3 * 20 * kSpans, 5.0 * std::sqrt(20 * kSpans * 0.3 * 0.7));
}

TEST(Phantoms, AreThereForSpansNearTheBase) {
  Disturbances d;
  d.detection.phantoms = {
      .count = 3, .probability = 0.4, .duration = 0.1, .radius = 0.2, .nearest = 1.0, .furthest = 2.0, .height = 1.5};
  SensingRig rig(d);
  World world;
  world.objects = {solid("phantom1", ShapeKind::kSphere, {0.1, 0, 0}, {3, 0, 0})};
  const std::vector<ObjectShape> shapes = rig.sensing().phantoms(world);
  ASSERT_EQ(shapes.size(), 3u);
  EXPECT_EQ(shapes[0].name, "phantom0");
  EXPECT_EQ(shapes[1].name, "phantom1'");
  EXPECT_EQ(shapes[2].shape.size.x(), 0.2);
  int there = 0;
  constexpr long kSpans = 300;
  Vector3 begun = Vector3::Zero();
  Observation last;
  for (long k = 0; k < 5 * kSpans; ++k) {
    const Observation seen = rig.sense(k);
    ASSERT_EQ(seen.objects.size(), 5u);
    if (k % 5 == 0) begun = rig.truth(k).base;
    for (std::size_t i = 2; i < 5; ++i) {
      const ObjectState& o = seen.objects[i];
      if (k % 5 != 0) {
        EXPECT_EQ(o.visible, last.objects[i].visible);
        EXPECT_EQ(o.X_WO.translation(), last.objects[i].X_WO.translation());
      } else {
        there += o.visible ? 1 : 0;
      }
      if (!o.visible) continue;
      const double distance = (o.X_WO.translation() - begun).head<2>().norm();
      EXPECT_GE(distance, 1.0 - 1e-9);
      EXPECT_LE(distance, 2.0 + 1e-9);
      EXPECT_GE(o.X_WO.translation().z(), 0.0);
      EXPECT_LE(o.X_WO.translation().z(), 1.5);
    }
    last = seen;
  }
  EXPECT_NEAR(there, 0.4 * 3 * kSpans, 5.0 * std::sqrt(3 * kSpans * 0.4 * 0.6));
}

VectorX command_of(double v, double omega, double joint = 0.0) {
  VectorX u(5);
  u << v, omega, joint, joint, joint;
  return u;
}

TEST(Actuation, HasADeadband) {
  Disturbances d;
  d.actuators.base.deadband = {0.05, 0.1};
  Actuation drives(d, *tiny_robot(), World{}, kPeriod);
  EXPECT_EQ(drives.act(0, command_of(0.05, 0.2, 0.01)), command_of(0.0, 0.2, 0.01));
  EXPECT_EQ(drives.act(1, command_of(-0.06, -0.1, 0.01)), command_of(-0.06, 0.0, 0.01));
}

TEST(Actuation, SlowsDownAndSpeedsUpAsItsRampsSay) {
  Disturbances d;
  d.actuators.base.ramps = {0.5, 0.25};
  const auto robot = tiny_robot();
  Actuation drives(d, *robot, World{}, kPeriod);
  const Vector2 a = robot->base.max_acceleration;
  long k = 0;
  for (int i = 1; i <= 5; ++i) {
    const VectorX u = drives.act(k++, command_of(1.0, -2.0));
    EXPECT_NEAR(u[0], i * 0.5 * a.x() * kPeriod, 1e-12);
    EXPECT_NEAR(u[1], -i * 0.5 * a.y() * kPeriod, 1e-12);
  }
  const double v = 5 * 0.5 * a.x() * kPeriod;
  // Down is half as fast, a reversal begins by slowing down, and what is near enough is reached.
  EXPECT_NEAR(drives.act(k++, command_of(0.0, 0.0))[0], v - 0.25 * a.x() * kPeriod, 1e-12);
  EXPECT_NEAR(drives.act(k++, command_of(-1.0, 0.0))[0], v - 2 * 0.25 * a.x() * kPeriod, 1e-12);
  const double now = v - 2 * 0.25 * a.x() * kPeriod;
  EXPECT_NEAR(drives.act(k++, command_of(now + 0.001, 0.0))[0], now + 0.001, 1e-12);
}

// The way of v' = (w - v)/lag, integrated in small steps, is the way of the applied command.
TEST(Actuation, LagsAsAFirstOrderSystem) {
  constexpr double kBaseLag = 0.15, kJointLag = 0.03;
  Disturbances d;
  d.actuators.base.lag = kBaseLag;
  d.actuators.joints.lag = kJointLag;
  Actuation drives(d, *tiny_robot(), World{}, kPeriod);
  double base = 0.0, joint = 0.0;  // velocities
  for (long k = 0; k < 40; ++k) {
    const double w = k < 20 ? 0.5 : -0.2, w_joint = std::sin(0.3 * static_cast<double>(k));
    const VectorX applied = drives.act(k, command_of(w, 0.0, w_joint));
    double way_base = 0.0, way_joint = 0.0;
    constexpr int kSteps = 4000;
    constexpr double kInterval = kPeriod / kSteps;
    for (int i = 0; i < kSteps; ++i) {  // the midpoint rule
      const double base_mid = base + 0.5 * kInterval * (w - base) / kBaseLag;
      const double joint_mid = joint + 0.5 * kInterval * (w_joint - joint) / kJointLag;
      way_base += kInterval * base_mid;
      way_joint += kInterval * joint_mid;
      base += kInterval * (w - base_mid) / kBaseLag;
      joint += kInterval * (w_joint - joint_mid) / kJointLag;
    }
    EXPECT_NEAR(applied[0] * kPeriod, way_base, 1e-9) << k;
    EXPECT_EQ(applied[1], 0.0);
    for (int i = 2; i < 5; ++i) EXPECT_NEAR(applied[i] * kPeriod, way_joint, 1e-9) << k;
  }
}

TEST(Actuation, KeepsTheLastCommandWhereOneIsLost) {
  Disturbances d;
  d.actuators.base.irregularity.dropout = 0.3;
  Actuation drives(d, *tiny_robot(), World{}, kPeriod);
  double last = 0.0;
  int kept = 0;
  constexpr int kSteps = 2000;
  for (int k = 0; k < kSteps; ++k) {
    const double v = 0.001 * (k + 1);
    const VectorX u = drives.act(k, command_of(v, 0.0, v));
    EXPECT_EQ(u[2], v) << "joints have a way of their own";
    if (u[0] == v) {
      last = v;
      continue;
    }
    EXPECT_EQ(u[0], last);
    ++kept;
  }
  EXPECT_NEAR(kept, 0.3 * kSteps, 5.0 * std::sqrt(kSteps * 0.3 * 0.7));
}

}  // namespace
}  // namespace moma::test
