// Ramps, braking, filters and round trips against simulations in fine steps that share no code with them.

#include <gtest/gtest.h>

#include <cmath>

#include "controller/model/kinematics.h"
#include "controller/params.h"
#include "controller/safe/base_ramp.h"
#include "controller/safe/braking.h"
#include "controller/safe/pose_track.h"
#include "controller/safe/round_trip.h"
#include "tests/controller/qp_robots.h"
#include "tests/support/control_period.h"

namespace moma {
namespace {

using namespace test;

// A drive in steps of a microsecond: the velocity vector walks towards the command, no step longer than a h.
Vector3 simulated_drive(const RobotModel& model, const Vector3& command, Vector3& velocity) {
  constexpr int kSteps = 20000;
  const double h = kPeriod / kSteps;
  const int dof = model.base_dof();
  Vector3 sum = Vector3::Zero();
  for (int k = 0; k < kSteps; ++k) {
    const Vector3 before = velocity;
    double linear = 0.0;
    for (int i = 0; i + 1 < dof; ++i) linear += (command[i] - velocity[i]) * (command[i] - velocity[i]);
    linear = std::sqrt(linear);
    const double part = linear > 0.0 ? std::min(1.0, model.base.max_acceleration.x() * h / linear) : 0.0;
    for (int i = 0; i + 1 < dof; ++i) velocity[i] += part * (command[i] - velocity[i]);
    const double turn = command[dof - 1] - velocity[dof - 1], most = model.base.max_acceleration.y() * h;
    velocity[dof - 1] += std::fabs(turn) > most ? std::copysign(most, turn) : turn;
    sum += 0.5 * (before + velocity);
  }
  return sum / kSteps;
}

TEST(BaseRamp, IsWhatADriveInFineStepsDoes) {
  Rng rng(1);
  for (const auto& model : {frankie(), mecanum()}) {
    const BaseRamp ramp(*model);
    for (int trial = 0; trial < 60; ++trial) {
      Vector3 from = Vector3::Zero(), to = Vector3::Zero();
      const double size = trial % 3 == 0 ? 0.02 : 1.0;  // within one period, or not
      for (int i = 0; i < model->base_dof(); ++i) {
        from[i] = uniform(rng, -1, 1);
        to[i] = from[i] + uniform(rng, -size, size);
      }
      if (trial == 0) to = from;
      Vector3 expected = from, reached = from;
      const Vector3 mean_expected = simulated_drive(*model, to, expected);
      const Vector3 mean = ramp.follow(to, kPeriod, reached);
      EXPECT_LT((reached - expected).norm(), 1e-6) << model->name << " trial " << trial;
      EXPECT_LT((mean - mean_expected).norm(), 5e-6) << model->name << " trial " << trial;
    }
  }
}

TEST(BaseRamp, FollowsWithItsShares) {
  BaseRamp ramp(*frankie());  // 2 m/s^2
  ramp.set_shares({0.5, 0.25});
  Vector3 velocity(0.5, 0.0, 0.0);
  ramp.follow({1.0, 0.0, 0.0}, 0.1, velocity);
  EXPECT_NEAR(velocity[0], 0.6, 1e-12);
  ramp.follow({0.0, 0.0, 0.0}, 0.1, velocity);
  EXPECT_NEAR(velocity[0], 0.55, 1e-12);
  EXPECT_NEAR(ramp.stopping_time({1.0, 0.0, 0.0}, 1.0), 2.0, 1e-12);
  const auto model = frankie();
  const VectorX a = VectorX::Constant(model->num_velocities(), 2.0);
  Deceleration deceleration(*model, a, true);
  deceleration.set_slowing(0.5);
  VectorX times(a.size());
  deceleration.stopping_times(a, times);
  EXPECT_EQ(times[0], 2.0);
  EXPECT_EQ(times[1], 2.0);
  EXPECT_EQ(times[2], 1.0) << "the arm brakes as before";
}

TEST(BaseRamp, StopsInTheTimeThatADriveNeeds) {
  for (const auto& model : {frankie(), mecanum()}) {
    const Vector3 start = model->base_dof() == 3 ? Vector3(0.6, -0.8, 0.5) : Vector3(0.9, -1.0, 0.0);
    const double time = BaseRamp(*model).stopping_time(start, 1.0);
    Vector3 velocity = start;
    double spent = 0.0;
    while (velocity.norm() > 1e-9 && spent < 5.0) {
      simulated_drive(*model, Vector3::Zero(), velocity);
      spent += kPeriod;
    }
    EXPECT_GT(time, spent - kPeriod - 1e-9);
    EXPECT_LT(time, spent + 1e-9);
  }
  EXPECT_EQ(BaseRamp(*panda()).stopping_time(Vector3::Zero(), 1.0), 0.0);
}

TEST(StoppableSpeed, IsThatFromWhichOneStopsThere) {
  for (const double room : {0.001, 0.03, 0.4, 2.0}) {
    for (const double a : {0.3, 2.0, 12.0}) {
      for (const double reaction : {0.0, 0.02, 0.3}) {
        const double speed = stoppable_speed(room, a, reaction);
        // Driven in small steps: on for the reaction, then down.
        constexpr double kStep = 1e-6;
        double way = 0.0, v = speed;
        for (double t = 0.0; v > 0.0; t += kStep) {
          way += v * kStep;
          if (t >= reaction) v -= a * kStep;
        }
        EXPECT_NEAR(way, room, 1e-4 * room + 3e-6 * speed + 1e-7) << room << " " << a << " " << reaction;
      }
    }
  }
  EXPECT_EQ(stoppable_speed(0.0, 2.0, 0.1), 0.0);
  EXPECT_EQ(stoppable_speed(-0.1, 2.0, 0.1), 0.0);
  EXPECT_EQ(stoppable_speed(0.1, kInfinity, 0.05), 2.0);
  EXPECT_TRUE(std::isinf(stoppable_speed(0.1, kInfinity, 0.0)));
}

TEST(Deceleration, IsTheMostThatAllowedChangesTakeOffARow) {
  Rng rng(2);
  for (const auto& model : built_robots()) {
    VectorX a = VectorX::NullaryExpr(model->num_velocities(), [&] { return uniform(rng, 0.5, 5.0); });
    const bool pair = model->base_dof() == 3;
    if (pair) a[1] = a[0];
    const Deceleration deceleration(*model, a, true);
    const VectorX c = VectorX::NullaryExpr(model->num_velocities(), [&] { return uniform(rng, -1, 1); });
    double most = 0.0;
    for (int trial = 0; trial < 20000; ++trial) {
      VectorX change = a;
      for (double& x : change) x *= rng() % 2 == 0 ? -1.0 : 1.0;
      if (pair) {
        const double angle = uniform(rng, -kPi, kPi);
        change.head<2>() = a[0] * Vector2(std::cos(angle), std::sin(angle));
      }
      most = std::max(most, c.dot(change));
    }
    EXPECT_LE(most, deceleration.along(c) + 1e-12) << model->name;
    EXPECT_GT(most, deceleration.along(c) - 1e-3) << model->name;
  }
  VectorX a = VectorX::Constant(9, kInfinity);
  a[0] = 2.0;
  VectorX c = VectorX::Zero(9);
  c[0] = -0.5;
  EXPECT_EQ(Deceleration(*frankie(), a, false).along(c), 1.0);  // what does not count may be infinite
  c[3] = 0.1;
  EXPECT_TRUE(std::isinf(Deceleration(*frankie(), a, false).along(c)));
}

Isometry at(double x, double yaw) { return pose(x, 0.3, 0.5, 0, 0, yaw); }

TEST(PoseFilter, IsTheMeanAtFirstAndExponentialLater) {
  const PoseFilter filter({.resting = 0.4, .moving = 0.1, .velocity = 0.15}, {}, kPeriod);
  Rng rng(3);
  PoseTrack track;
  double sum = 0.0;
  for (int n = 1; n <= 20; ++n) {  // T/tau is 1/20
    const double x = uniform(rng, -0.02, 0.02);
    sum += x;
    filter.measure(at(x, 0.0), Vector6::Zero(), track);
    EXPECT_NEAR(track.X_W().translation().x(), sum / n, 1e-15) << n;
    EXPECT_NEAR(track.pose_spread, 1.0 / n, 1e-12) << n;
  }
  const double before = track.X_W().translation().x();
  filter.measure(at(0.02, 0.0), Vector6::Zero(), track);
  EXPECT_NEAR(track.X_W().translation().x(), before + 0.05 * (0.02 - before), 1e-15);
}

TEST(PoseFilter, BeginsAfreshWhereAnotherPoseIsMeasured) {
  const PoseFilter filter({.resting = 0.4, .moving = 0.1, .velocity = 0.15}, {}, kPeriod);
  PoseTrack track;
  for (int n = 0; n < 50; ++n) filter.measure(at(0.0, 0.0), Vector6::Zero(), track);
  filter.measure(at(0.099, 0.0), Vector6::Zero(), track);
  EXPECT_LT(track.X_W().translation().x(), 0.01);
  filter.measure(at(0.2, 0.0), Vector6::Zero(), track);
  EXPECT_EQ(track.X_W().translation().x(), 0.2);
  EXPECT_EQ(track.seen, 1);
  filter.measure(at(0.2, 0.15), Vector6::Zero(), track);
  EXPECT_NEAR(log_so3(track.X_W().linear()).z(), 0.15, 1e-12);
}

TEST(PoseFilter, FollowsWhatMovesWithoutLag) {
  const PoseFilter filter({.resting = 0.4, .moving = 0.1, .velocity = 0.15}, {}, kPeriod);
  Vector6 V;
  V << 0, 0, 0.5, 0.4, 0, 0;
  PoseTrack track;
  for (int k = 0; k <= 200; ++k) {
    filter.measure(at(0.4 * kPeriod * k, 0.5 * kPeriod * k), V, track);
    EXPECT_TRUE(track.moving);
    EXPECT_NEAR(track.X_W().translation().x(), 0.4 * kPeriod * k, 1e-12) << k;
  }
  // At rest at once where the sensor says so, then without it for as long as it is not seen.
  filter.measure(at(1.6, 0.0), Vector6::Zero(), track);
  EXPECT_FALSE(track.moving);
  EXPECT_EQ(track.seen, 1);
  EXPECT_TRUE(track.V_W.isZero(0.0));
}

TEST(PoseFilter, CoastsWhereNothingIsMeasured) {
  const PoseFilter filter({}, {}, kPeriod);
  Vector6 V = Vector6::Zero();
  V[3] = 0.5;
  PoseTrack track;
  filter.coast(track);
  EXPECT_EQ(track.seen, 0);
  filter.measure(at(0.0, 0.0), V, track);
  for (int k = 0; k < 50; ++k) filter.coast(track);
  EXPECT_NEAR(track.X_W().translation().x(), 0.5, 1e-12);
  EXPECT_NEAR(track.unseen, 1.0, 1e-12);
}

// Spreads say how much noise is left: over many tracks, the variance that is there.
TEST(PoseFilter, KnowsHowMuchNoiseIsLeft) {
  const PoseFilter filter({.resting = 0.2, .moving = 0.1, .velocity = 0.15}, {.linear = 0.15, .angular = 0.15},
                          kPeriod);
  Rng rng(4);
  std::normal_distribution<double> normal;
  double pose_square = 0.0, twist_square = 0.0, pose_spread = 0.0, twist_spread = 0.0;
  constexpr int kTracks = 4000;
  for (int n = 0; n < kTracks; ++n) {
    PoseTrack track;
    for (int k = 0; k < 40; ++k) {
      Vector6 V = Vector6::Zero();
      V[3] = 0.001 * normal(rng);
      filter.measure(at(0.005 * normal(rng), 0.0), V, track);
    }
    pose_square += std::pow(track.X_W().translation().x() / 0.005, 2);
    twist_square += std::pow(track.V_W[3] / 0.001, 2);
    pose_spread = track.pose_spread;
    twist_spread = track.twist_spread;
    EXPECT_FALSE(track.moving);
  }
  EXPECT_NEAR(pose_square / kTracks, pose_spread, 0.1 * pose_spread);
  EXPECT_NEAR(twist_square / kTracks, twist_spread, 0.1 * twist_spread);
}

TEST(PoseFilter, TakesNoiseForNoMotionAndMotionForMotion) {
  // Three standard deviations of 0.05 m/s.
  const PoseFilter filter({.resting = 0.4, .moving = 0.1, .velocity = 0.15}, {.linear = 0.15, .angular = 0.15},
                          kPeriod);
  Rng rng(5);
  std::normal_distribution<double> normal(0.0, 0.05);
  PoseTrack resting, walking;
  int wrong = 0, found = 0;
  for (int k = 0; k < 5000; ++k) {
    Vector6 V = Vector6::Zero();
    for (int i = 3; i < 6; ++i) V[i] = normal(rng);
    filter.measure(at(0.0, 0.0), V, resting);
    wrong += resting.moving ? 1 : 0;
    V[3] += 0.3;
    filter.measure(at(0.3 * kPeriod * k, 0.0), V, walking);
    found += walking.moving ? 1 : 0;
  }
  EXPECT_LT(wrong, 250);
  EXPECT_GT(found, 4900);
}

// A velocity that follows commands five periods later, with noise, is found to; a robot at rest says nothing.
TEST(RoundTrip, IsFoundFromMotion) {
  Rng rng(6);
  std::normal_distribution<double> normal(0.0, 0.007);
  const EstimationParams params;
  const double part = kPeriod / params.forget;
  for (const int late : {0, 1, 5, 11}) {
    RoundTrip trip{3, VectorX::Zero(12)};
    std::vector<double> sent(20, 0.0);
    bool changed = false;
    for (int k = 0; k < 100; ++k) {
      for (int age = 0; age < 12; ++age) settle(trip.misfit, age, std::pow(normal(rng), 2), part);
      changed = chosen(trip.misfit, trip.periods, 2e-4, params.better) != trip.periods || changed;
    }
    EXPECT_FALSE(changed) << "noise alone";
    for (int k = 0; k < 150; ++k) {
      const double measured = sent[static_cast<std::size_t>(late)] + normal(rng);
      for (int age = 0; age < 12; ++age)
        settle(trip.misfit, age, std::pow(measured - sent[static_cast<std::size_t>(age)], 2), part);
      trip.periods = chosen(trip.misfit, trip.periods, 2e-4, params.better);
      sent.insert(sent.begin(), 0.5 * std::sin(3.0 * kPeriod * k));
    }
    EXPECT_EQ(trip.periods, late);
  }
}

}  // namespace
}  // namespace moma
