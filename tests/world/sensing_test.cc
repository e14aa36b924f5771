// Each sensing error alone: what the controller sees against the truth and the parameter, on scripted truths.
#include "world/sensing/sensing.h"
#include "tests/support/control_period.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/no_alloc.h"
#include "tests/support/tiny_robot.h"
#include "tests/world/sensing_support.h"
#include "tests/world/support.h"

namespace moma::test {
namespace {

// Mean, standard deviation and lag-1 correlation of what a channel adds, over many steps.
struct Statistics {
  double mean = 0.0, sigma = 0.0, lag1 = 0.0;
  long n = 0;
};

Statistics statistics(const std::vector<double>& x) {
  Statistics out;
  out.n = static_cast<long>(x.size());
  for (const double v : x) out.mean += v / static_cast<double>(out.n);
  double product = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    out.sigma += (x[i] - out.mean) * (x[i] - out.mean);
    if (i > 0) product += (x[i] - out.mean) * (x[i - 1] - out.mean);
  }
  out.lag1 = out.sigma > 0.0 ? product / out.sigma : 0.0;
  out.sigma = std::sqrt(out.sigma / static_cast<double>(out.n - 1));
  return out;
}

// White normal noise of n draws: the mean's own deviation is sigma / sqrt(n), that of sigma sigma / sqrt(2 n). Five
// deviations each; the draws are fixed, so that the test either always passes or never.
void expect_white(const std::vector<double>& x, double sigma, const std::string& what) {
  const Statistics s = statistics(x);
  const double n = static_cast<double>(s.n);
  EXPECT_NEAR(s.mean, 0.0, 5.0 * sigma / std::sqrt(n)) << what;
  EXPECT_NEAR(s.sigma, sigma, 5.0 * sigma / std::sqrt(2.0 * n)) << what;
  EXPECT_NEAR(s.lag1, 0.0, 5.0 / std::sqrt(n)) << what;
  EXPECT_GT(s.sigma, 0.0) << what;
}

Vector3 rotation_between(const Isometry& truth, const Isometry& seen) {
  return log_so3(seen.linear() * truth.linear().transpose());
}

TEST(Sensing, NothingOnIsTheTruth) {
  SensingRig rig(Disturbances{});
  for (long k = 0; k < 100; ++k) rig.expect_same(rig.sense(k), rig.truth(k));
}

TEST(Sensing, NoiseHasTheGivenDeviationIsWhiteAndLeavesTheRestAlone) {
  constexpr long kSteps = 4000;
  struct Case {
    const char* name;
    void (*set)(Disturbances&, double);
    double sigma;
    std::vector<double> (*differences)(const Observation& seen, const Observation& truth);
  };
  using D = Disturbances;
  using O = Observation;
  const std::vector<Case> cases = {
      {"joints.noise", [](D& d, double s) { d.joints.noise = s; }, 0.002,
       [](const O& s, const O& t) { return values(s.q - t.q); }},
      {"joints.velocity_noise", [](D& d, double s) { d.joints.velocity_noise = s; }, 0.03,
       [](const O& s, const O& t) { return values((s.qdot - t.qdot).tail(3)); }},
      {"base.noise.position", [](D& d, double s) { d.base.noise.position = s; }, 0.01,
       [](const O& s, const O& t) { return values((s.base - t.base).head(2)); }},
      {"base.noise.rotation", [](D& d, double s) { d.base.noise.rotation = s; }, 0.004,
       [](const O& s, const O& t) { return values((s.base - t.base).tail(1)); }},
      {"base.velocity_noise.linear", [](D& d, double s) { d.base.velocity_noise.linear = s; }, 0.02,
       [](const O& s, const O& t) { return values((s.qdot - t.qdot).head(1)); }},
      {"base.velocity_noise.angular", [](D& d, double s) { d.base.velocity_noise.angular = s; }, 0.05,
       [](const O& s, const O& t) { return values((s.qdot - t.qdot).segment(1, 1)); }},
      {"objects.noise.position", [](D& d, double s) { d.objects.noise.position = s; }, 0.01,
       [](const O& s, const O& t) {
         return values(s.objects[1].X_WO.translation() - t.objects[1].X_WO.translation());
       }},
      {"objects.noise.rotation", [](D& d, double s) { d.objects.noise.rotation = s; }, 0.02,
       [](const O& s, const O& t) { return values(rotation_between(t.objects[1].X_WO, s.objects[1].X_WO)); }},
      {"objects.velocity_noise.linear", [](D& d, double s) { d.objects.velocity_noise.linear = s; }, 0.05,
       [](const O& s, const O& t) { return values((s.objects[1].V_WO_W - t.objects[1].V_WO_W).tail(3)); }},
      {"objects.velocity_noise.angular", [](D& d, double s) { d.objects.velocity_noise.angular = s; }, 0.1,
       [](const O& s, const O& t) { return values((s.objects[1].V_WO_W - t.objects[1].V_WO_W).head(3)); }},
      {"goal.noise.position", [](D& d, double s) { d.goal.noise.position = s; }, 0.003,
       [](const O& s, const O& t) { return values(s.goal.X_WG.translation() - t.goal.X_WG.translation()); }},
      {"goal.noise.rotation", [](D& d, double s) { d.goal.noise.rotation = s; }, 0.01,
       [](const O& s, const O& t) { return values(rotation_between(t.goal.X_WG, s.goal.X_WG)); }},
      {"goal.velocity_noise.linear", [](D& d, double s) { d.goal.velocity_noise.linear = s; }, 0.01,
       [](const O& s, const O& t) { return values((s.goal.V_WG_W - t.goal.V_WG_W).tail(3)); }},
      {"goal.velocity_noise.angular", [](D& d, double s) { d.goal.velocity_noise.angular = s; }, 0.02,
       [](const O& s, const O& t) { return values((s.goal.V_WG_W - t.goal.V_WG_W).head(3)); }},
  };
  for (const Case& c : cases) {
    Disturbances d;
    c.set(d, c.sigma);
    ASSERT_TRUE(senses_with_errors(d)) << c.name;
    SensingRig rig(d);
    std::vector<std::vector<double>> channels;
    for (long k = 0; k < kSteps; ++k) {
      const Observation truth = rig.truth(k), seen = rig.sense(k);
      const std::vector<double> x = c.differences(seen, truth);
      channels.resize(x.size());
      for (std::size_t i = 0; i < x.size(); ++i) channels[i].push_back(x[i]);
      // Everything else is the truth, bit for bit: exactly one part differs.
      ASSERT_EQ(parts_that_differ(seen, truth), 1) << c.name << " at step " << k;
    }
    for (std::size_t i = 0; i < channels.size(); ++i)
      expect_white(channels[i], c.sigma, std::string(c.name) + " " + std::to_string(i));
    // Neither are two channels the same draws.
    for (std::size_t i = 1; i < channels.size(); ++i) {
      double product = 0.0;
      for (std::size_t k = 0; k < channels[0].size(); ++k) product += channels[0][k] * channels[i][k];
      EXPECT_NEAR(product / (c.sigma * c.sigma * kSteps), 0.0, 5.0 / std::sqrt(static_cast<double>(kSteps))) << c.name;
    }
  }
}

TEST(Sensing, ABiasIsConstantInATrialAndSpreadOverWorlds) {
  Disturbances d;
  d.joints.bias = 0.01;
  d.base.bias = {0.02, 0.03};
  d.objects.bias = {0.04, 0.05};
  d.goal.bias = {0.06, 0.07};
  std::vector<double> q, base, heading, object, object_turn, goal, goal_turn;
  for (std::uint64_t world = 0; world < 1000; ++world) {
    SensingRig rig(d, world);
    rig.further = true;
    const Observation first = rig.sense(0), truth = rig.truth(0);
    if (world < 5) {
      const Observation later = rig.sense(1), then = rig.truth(1);
      EXPECT_LT(((later.q - then.q) - (first.q - truth.q)).norm(), 1e-14);
      EXPECT_LT(((later.base - then.base) - (first.base - truth.base)).norm(), 1e-14);
    }
    q.push_back(first.q[1] - truth.q[1]);
    base.push_back(first.base.x() - truth.base.x());
    heading.push_back(first.base.z() - truth.base.z());
    object.push_back(first.objects[1].X_WO.translation().y() - truth.objects[1].X_WO.translation().y());
    object_turn.push_back(rotation_between(truth.objects[1].X_WO, first.objects[1].X_WO).x());
    goal.push_back(first.goal.X_WG.translation().z() - truth.goal.X_WG.translation().z());
    EXPECT_EQ(first.next->X_WG.matrix(), first.goal.X_WG.matrix()) << "one sensor sees all goals";
    goal_turn.push_back(rotation_between(truth.goal.X_WG, first.goal.X_WG).y());
    EXPECT_NE(first.objects[0].X_WO.translation().y() - truth.objects[0].X_WO.translation().y(), object.back());
  }
  expect_white(q, 0.01, "joints.bias");
  expect_white(base, 0.02, "base.bias.position");
  expect_white(heading, 0.03, "base.bias.rotation");
  expect_white(object, 0.04, "objects.bias.position");
  expect_white(object_turn, 0.05, "objects.bias.rotation");
  expect_white(goal, 0.06, "goal.bias.position");
  expect_white(goal_turn, 0.07, "goal.bias.rotation");
}

TEST(Sensing, ADelayHandsOnEarlierMeasurementsAsTheyWereMade) {
  Disturbances noisy;
  noisy.joints.noise = noisy.base.noise.position = noisy.objects.noise.position = noisy.goal.noise.position = 0.01;
  Disturbances late = noisy;
  late.joints.delay = 0.06;   // 3 steps
  late.base.delay = 0.02;     // 1
  late.objects.delay = 0.05;  // 2.5, rounded up: 3
  late.goal.delay = 0.1;      // 5
  SensingRig now(noisy), then(late);
  now.further = then.further = true;
  std::vector<Observation> made;
  for (long k = 0; k < 60; ++k) {
    made.push_back(now.sense(k));
    const Observation seen = then.sense(k);
    const auto at = [&](long steps) -> const Observation& {
      return made[static_cast<std::size_t>(std::max(0L, k - steps))];
    };
    ASSERT_EQ(seen.q, at(3).q) << k;
    ASSERT_EQ(seen.qdot.tail(3), at(3).qdot.tail(3)) << k;
    ASSERT_EQ(seen.base, at(1).base) << k;
    ASSERT_EQ(seen.qdot.head(2), at(1).qdot.head(2)) << k;
    for (std::size_t i = 0; i < 2; ++i) {
      ASSERT_EQ(seen.objects[i].X_WO.matrix(), at(3).objects[i].X_WO.matrix()) << k;
      ASSERT_EQ(seen.objects[i].V_WO_W, at(3).objects[i].V_WO_W) << k;
    }
    ASSERT_EQ(seen.goal.X_WG.matrix(), at(5).goal.X_WG.matrix()) << k;
    ASSERT_EQ(seen.next->X_WG.matrix(), at(5).next->X_WG.matrix()) << k;
    ASSERT_NE(made.back().next->X_WG.translation().x(), made.back().goal.X_WG.translation().x()) << "noise of its own";
    ASSERT_EQ(seen.time, made.back().time);
  }
}

TEST(Sensing, DelaysAreRoundedUpToWholePeriods) {
  EXPECT_EQ(delay_steps(0.0, 0.02), 0);
  EXPECT_EQ(delay_steps(0.001, 0.02), 1);
  EXPECT_EQ(delay_steps(0.02, 0.02), 1);
  EXPECT_EQ(delay_steps(0.06, 0.02), 3) << "0.06 / 0.02 is a little more than 3 in floating point";
  EXPECT_EQ(delay_steps(0.061, 0.02), 4);
  EXPECT_EQ(delay_steps(0.3, 0.1), 3);
}

TEST(Sensing, EachErrorHasAStreamOfItsOwn) {
  // All on, then one after the other off: what the others add must not move by a bit. Positions are off zero in
  // every channel, so that a sum with another error would round differently; therefore channels are compared alone.
  Disturbances all;
  all.joints = {0.001, 0.01, 0.0, 0.0};
  all.base.noise = {0.01, 0.01};
  all.base.velocity_noise = {0.01, 0.01};
  all.objects.noise = {0.01, 0.01};
  all.objects.velocity_noise = {0.01, 0.01};
  all.goal.noise = {0.01, 0.01};
  all.goal.velocity_noise = {0.01, 0.01};
  using Set = void (*)(Disturbances&);
  const std::vector<Set> off = {
      [](Disturbances& d) { d.joints.noise = 0; },
      [](Disturbances& d) { d.joints.velocity_noise = 0; },
      [](Disturbances& d) { d.base.noise.position = 0; },
      [](Disturbances& d) { d.base.noise.rotation = 0; },
      [](Disturbances& d) { d.base.velocity_noise.linear = 0; },
      [](Disturbances& d) { d.base.velocity_noise.angular = 0; },
      [](Disturbances& d) { d.objects.noise.position = 0; },
      [](Disturbances& d) { d.objects.noise.rotation = 0; },
      [](Disturbances& d) { d.objects.velocity_noise.linear = 0; },
      [](Disturbances& d) { d.objects.velocity_noise.angular = 0; },
      [](Disturbances& d) { d.goal.noise.position = 0; },
      [](Disturbances& d) { d.goal.noise.rotation = 0; },
      [](Disturbances& d) { d.goal.velocity_noise.linear = 0; },
      [](Disturbances& d) { d.goal.velocity_noise.angular = 0; },
  };
  for (std::size_t i = 0; i < off.size(); ++i) {
    Disturbances fewer = all;
    off[i](fewer);
    SensingRig with(all), without(fewer);
    for (long k = 0; k < 50; ++k) {
      const Observation a = with.sense(k), b = without.sense(k);
      ASSERT_EQ(parts_that_differ(a, b), 1) << "disturbance " << i << " at step " << k;
    }
  }
  // Another object, another seed of the section.
  SensingRig two(all, 4), three(all, 4, 3);
  Disturbances reseeded = all;
  reseeded.seed = 1;
  SensingRig other(reseeded, 4);
  const Observation a = two.sense(0), b = three.sense(0), c = other.sense(0);
  EXPECT_EQ(a.objects[1].X_WO.matrix(), b.objects[1].X_WO.matrix());
  EXPECT_EQ(a.q, b.q);
  EXPECT_NE(a.q, c.q);
  EXPECT_NE(a.objects[1].X_WO.matrix(), c.objects[1].X_WO.matrix());
}

// What a seed means, written down: sources by their numbers, and where step, object and seed enter.
TEST(Sensing, DrawsAreThoseOfTheDocumentedStreams) {
  Disturbances d;
  d.seed = 2;
  d.joints.noise = 0.001;
  d.base.noise.rotation = 0.002;
  d.objects.noise.position = 0.003;
  d.goal.velocity_noise.angular = 0.004;
  SensingRig rig(d, 6);
  for (long k = 0; k < 3; ++k) rig.sense(k);
  const Observation truth = rig.truth(3), seen = rig.sense(3);
  const auto draws = [](std::uint64_t source, std::uint64_t object) {
    return Draws(5, 6, Stream::kSensing, 3, (std::uint64_t{2} << 32) + 256 * object + source);
  };
  Draws q = draws(1, 0), heading = draws(5, 0), place = draws(15, 1), turning = draws(24, 0);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(seen.q[i] - truth.q[i], q.normal(0.0, 0.001), 1e-15);
    EXPECT_NEAR(seen.objects[1].X_WO.translation()[i] - truth.objects[1].X_WO.translation()[i],
                place.normal(0.0, 0.003), 1e-15);
    EXPECT_NEAR(seen.goal.V_WG_W[i] - truth.goal.V_WG_W[i], turning.normal(0.0, 0.004), 1e-15);
  }
  EXPECT_NEAR(seen.base.z() - truth.base.z(), heading.normal(0.0, 0.002), 1e-15);
}

TEST(Sensing, WhatIsSeenFromTheBaseIsRightRelativeToIt) {
  Disturbances d;
  d.base.bias = {0.1, 0.2};
  d.base.noise = {0.01, 0.02};
  d.objects.frame = SensingFrame::kBase;
  SensingRig rig(d, 7);
  const auto pose = [](const Vector3& base) {
    Isometry X = Isometry::Identity();
    X.linear() = Eigen::AngleAxisd(base.z(), Vector3::UnitZ()).toRotationMatrix();
    X.translation() = Vector3(base.x(), base.y(), 0.0);
    return X;
  };
  for (long k = 0; k < 20; ++k) {
    const Observation truth = rig.truth(k), seen = rig.sense(k);
    ASSERT_GT((seen.base - truth.base).norm(), 1e-3);
    for (std::size_t i = 0; i < 2; ++i) {
      const Isometry relative = pose(truth.base).inverse() * truth.objects[i].X_WO;
      const Isometry as_seen = pose(seen.base).inverse() * seen.objects[i].X_WO;
      EXPECT_LT((relative.matrix() - as_seen.matrix()).norm(), 1e-12);
      const Vector3 v = pose(truth.base).linear().transpose() * truth.objects[i].V_WO_W.tail<3>();
      const Vector3 v_seen = pose(seen.base).linear().transpose() * seen.objects[i].V_WO_W.tail<3>();
      EXPECT_LT((v - v_seen).norm(), 1e-12);
    }
    EXPECT_EQ(seen.goal.X_WG.matrix(), truth.goal.X_WG.matrix()) << "the goal is known in the world here";
  }
}

TEST(Sensing, WhatRestsMayBeKnownToRest) {
  Disturbances d;
  d.objects.velocity_noise = d.goal.velocity_noise = {0.1, 0.1};
  for (const bool known : {false, true}) {
    d.objects.resting_is_known = known;
    SensingRig rig(d);
    Observation seen = rig.truth(0);
    seen.objects[0].V_WO_W.setZero();
    seen.goal.V_WG_W.setZero();
    const Vector6 moving = seen.objects[1].V_WO_W;
    rig.sensing().sense(0, seen);
    EXPECT_EQ(seen.objects[0].V_WO_W.isZero(0.0), known);
    EXPECT_NE(seen.objects[1].V_WO_W, moving) << "what moves is measured with noise";
    EXPECT_FALSE(seen.goal.V_WG_W.isZero(0.0)) << "each has its own";
  }
}

TEST(Sensing, AFixedBaseHasNoErrors) {
  const auto model = robot("panda");
  Disturbances d;
  d.base.noise = d.base.bias = {0.1, 0.1};
  d.base.velocity_noise = {0.1, 0.1};
  d.base.odometry.distance = 0.1;
  d.base.delay = 0.1;
  const World world = empty_world(*model);
  Sensing sensing(d, *model, world, kPeriod);
  Observation seen;
  seen.q = model->ready;
  seen.qdot = VectorX::Zero(model->num_velocities());
  for (long k = 0; k < 10; ++k) {
    sensing.sense(k, seen);
    EXPECT_EQ(seen.base, Vector3::Zero());
    EXPECT_EQ(seen.q, model->ready);
  }
}

TEST(Sensing, AnOmnidirectionalBaseHasTwoLinearVelocitiesAndATurn) {
  const auto model = robot("frankie_omni");
  ASSERT_EQ(model->base_dof(), 3);
  Disturbances d;
  d.base.velocity_noise = {0.01, 0.5};
  d.base.delay = 0.02;
  World world = empty_world(*model);
  Sensing sensing(d, *model, world, kPeriod);
  std::vector<std::vector<double>> added(3);
  for (long k = 0; k < 2000; ++k) {
    Observation seen;
    seen.q = model->ready;
    seen.qdot = VectorX::Zero(model->num_velocities());
    sensing.sense(k, seen);
    for (int i = 0; i < 3; ++i) added[static_cast<std::size_t>(i)].push_back(seen.qdot[i]);
    ASSERT_EQ(seen.qdot.tail(7), VectorX::Zero(7));
  }
  expect_white(added[0], 0.01, "vx");
  expect_white(added[1], 0.01, "vy");
  expect_white(added[2], 0.5, "turn");
  EXPECT_NE(added[0], added[1]);
}

TEST(Sensing, AllocatesNothing) {
  if (!NoAlloc::works()) GTEST_SKIP() << "malloc is another's here";
  SensingRig rig(everything_on());
  Observation seen = rig.sense(0);
  const Observation truth = rig.truth(1);
  seen = truth;
  const NoAlloc guard;
  for (long k = 1; k < 100; ++k) rig.sensing().sense(k, seen);
  EXPECT_EQ(guard.count(), 0);
}

}  // namespace
}  // namespace moma::test
