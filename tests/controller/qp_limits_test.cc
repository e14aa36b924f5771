// Bounds from speeds, joint limits and accelerations, and the norms of the error, against their formulas by hand.

#include <gtest/gtest.h>

#include "controller/qp/limits.h"
#include "controller/safe/braking.h"
#include "controller/task/servo.h"
#include "tests/controller/qp_robots.h"

namespace moma {
namespace {

using namespace test;

// One revolute joint of range [-1, 1] and speed 2, and one that turns without end.
std::shared_ptr<const RobotModel> two_joints(double lower = -1.0, double upper = 1.0) {
  RobotBuilder b("two");
  b.joint(JointType::kRevolute, Isometry::Identity(), lower, upper, 2.0)
      .joint(JointType::kContinuous, Isometry::Identity(), -kInfinity, kInfinity, 3.0);
  return b.finish(Isometry::Identity(), {0.0, 0.0});
}

struct Bounds {
  double low, high;
};

Bounds bounds_at(const JointLimitParams& law, double q, const std::shared_ptr<const RobotModel>& model = two_joints(),
                 int joint = 0) {
  ControllerParams p;
  p.joint_limits = law;
  const VelocityBounds bounds(*model, resolved(p, *model), 0.02);
  VectorX low(2), high(2), at(2);
  at << q, q;
  bounds.joint_limits(at, low, high);
  return {low[joint], high[joint]};
}

TEST(Limits, SourceLaw) {
  JointLimitParams law;
  law.margin = {false, VectorX::Constant(2, 0.4)};
  const auto expect = [&](double q, double low, double high) {
    const Bounds b = bounds_at(law, q);
    EXPECT_NEAR(b.low, low, 1e-12) << q;
    EXPECT_NEAR(b.high, high, 1e-12) << q;
  };
  expect(0.0, -2, 2);
  expect(0.6, -2, 2);
  expect(0.8, -2, 1);
  expect(0.99, -2, 0.05);
  expect(1.0, -2, 0);
  expect(1.2, -2, 0);
  expect(-0.9, -0.5, 2);
  expect(-1.5, 0, 2);
}

TEST(Limits, MarginOfAutoIsAQuarterOfASmallRange) {
  EXPECT_EQ(resolve_margin(*two_joints(), {})[0], 0.3);
  EXPECT_EQ(resolve_margin(*two_joints(0.0, 0.35), {})[0], 0.0875);
  EXPECT_NEAR(bounds_at({}, 0.35 - 0.0875 / 2, two_joints(0.0, 0.35)).high, 1.0, 1e-12);
}

TEST(Limits, DamperLaw) {
  JointLimitParams law;
  law.method = JointLimitMethod::kDamper;
  law.influence = 0.5;
  law.stop = 0.1;
  law.gain = 0.8;
  const auto expect = [&](double q, double low, double high) {
    const Bounds b = bounds_at(law, q);
    EXPECT_NEAR(b.low, low, 1e-12) << q;
    EXPECT_NEAR(b.high, high, 1e-12) << q;
  };
  expect(0.0, -2, 2);
  expect(0.7, -2, 0.8 * 0.2 / 0.4);
  expect(0.9, -2, 0.0);
  expect(0.95, -2, -0.8 * 0.05 / 0.4);
  expect(-0.95, 0.8 * 0.05 / 0.4, 2);
  expect(1.9, -2, -2);  // far beyond: the speed limit holds
  law.gain = 100.0;
  expect(0.6, -2, 2);
}

// A joint that goes as fast towards its limit as it may, from any speed that it may have, meets its bound by braking
// within its limit, and stands where the law says.
TEST(Limits, BrakingLawIsMetWithinTheAccelerationLimit) {
  constexpr double kPeriod = 0.02, kMost = 5.0, kStop = 0.1;
  const auto model = two_joints();
  ControllerParams p;
  p.joint_limits.method = JointLimitMethod::kBraking;
  p.joint_limits.stop = kStop;
  p.joint_limits.share = 0.8;
  p.acceleration_limit = VectorX::Constant(2, kMost);
  const VelocityBounds bounds(*model, resolved(p, *model), kPeriod);
  EXPECT_FALSE(bounds.has_soft_acceleration());
  moma::Bounds b;
  b.allocate(2);
  for (const double start : {-0.9, -0.3, 0.4, 0.7, 0.85}) {
    VectorX q(2), v = VectorX::Zero(2);
    q << start, 0.0;
    double fastest = 0.0;
    for (int k = 0; k < 400; ++k) {
      bounds.bound(q, v, 1.0, b);
      EXPECT_EQ(b.upper[0], b.hard_upper[0]);
      EXPECT_LE(std::abs(b.upper[0] - v[0]), kMost * kPeriod + 1e-12) << "from " << start << " in step " << k;
      v[0] = b.upper[0];
      q[0] += kPeriod * v[0];
      fastest = std::max(fastest, v[0]);
      EXPECT_LE(q[0], 1.0 - kStop + 1e-9) << "from " << start << " in step " << k;
    }
    EXPECT_NEAR(q[0], 1.0 - kStop, 1e-3) << "from " << start;
    if (start == -0.9) {
      EXPECT_EQ(fastest, 2.0) << "the law costs no speed far from the limit";
    }
  }
}

// Where two of three steps are missed, each command acts for three periods.
TEST(Limits, BrakingLawHoldsWhereStepsAreMissed) {
  constexpr double kPeriod = 0.02, kStop = 0.1;
  const auto model = two_joints();
  ControllerParams p;
  p.joint_limits.method = JointLimitMethod::kBraking;
  p.joint_limits.stop = kStop;
  p.joint_limits.share = 0.8;
  p.acceleration_limit = VectorX::Constant(2, 5.0);
  const VelocityBounds bounds(*model, resolved(p, *model), kPeriod);
  moma::Bounds b;
  b.allocate(2);
  const auto furthest = [&](double hold) {
    VectorX q = VectorX::Zero(2), v = VectorX::Zero(2);
    double most = 0.0;
    for (int k = 0; k < 400; ++k) {
      if (k % 3 == 0) {
        bounds.bound(q, v, hold, b);
        v[0] = b.upper[0];
      }
      q[0] += kPeriod * v[0];
      most = std::max(most, q[0]);
    }
    return most;
  };
  EXPECT_GT(furthest(1.0), furthest(3.0) + 0.02) << "the test can fail";
  EXPECT_LT(furthest(3.0), 1.0) << "the limit";
}

TEST(Limits, BrakingLawLeadsBackAndNeverBreaksTheAccelerationLimit) {
  const auto model = two_joints();
  ControllerParams p;
  p.joint_limits.method = JointLimitMethod::kBraking;
  p.joint_limits.stop = 0.1;
  p.joint_limits.gain = 2.0;
  p.acceleration_limit = VectorX::Constant(2, 5.0);
  const VelocityBounds bounds(*model, resolved(p, *model), 0.02);
  moma::Bounds b;
  b.allocate(2);
  VectorX q(2), v(2);
  q << 0.95, 0.0;
  v << 0.0, 0.0;
  bounds.bound(q, v, 1.0, b);
  EXPECT_NEAR(b.upper[0], -0.1, 1e-12) << "2 x 5 cm beyond the stop, as fast as the limit lets it";
  v << 1.5, 0.0;
  bounds.bound(q, v, 1.0, b);
  EXPECT_NEAR(b.upper[0], 1.4, 1e-12) << "a joint that is too fast brakes as hard as it may, and no harder";
  EXPECT_NEAR(b.lower[0], 1.4, 1e-12);
  v << 2.3, 0.0;
  bounds.bound(q, v, 1.0, b);
  EXPECT_EQ(b.upper[0], 2.0) << "a measured velocity beyond the speed limit is no leave to keep it";
}

// A lift of 0.3 m: a tenth of the lengths, the same slope.
TEST(Limits, DampersOfAPrismaticJointAreShortInProportionToItsRange) {
  RobotBuilder b("lift");
  b.joint(JointType::kPrismatic, Isometry::Identity(), 0.0, 0.3, 0.5)
      .joint(JointType::kRevolute, Isometry::Identity(), 0.0, 0.3, 0.5);
  const auto model = b.finish(Isometry::Identity(), {0.1, 0.1});
  JointLimitParams law;
  law.method = JointLimitMethod::kDamper;
  law.influence = 0.9;
  law.stop = 0.1;
  law.gain = 1.0;
  EXPECT_NEAR(bounds_at(law, 0.25, model).high, (0.05 - 0.01) / 0.8, 1e-12);
  EXPECT_NEAR(bounds_at(law, 0.29, model).high, 0.0, 1e-12);
  EXPECT_NEAR(bounds_at(law, 0.295, model).high, -0.005 / 0.8, 1e-12);
  EXPECT_NEAR(bounds_at(law, 0.05, model).low, -0.04 / 0.8, 1e-12);
  EXPECT_EQ(bounds_at(law, 0.15, model).high, 0.5) << "nearer than influence says, but far for such a joint";
  EXPECT_NEAR(bounds_at(law, 0.15, model, 1).high, (0.15 - 0.1) / 0.8, 1e-12) << "a revolute one has them as they are";
}

// From its full speed at the distance at which rows begin, braking at full after the reaction, a base stands at their
// stop. Nearer to objects the damper is the configured one.
TEST(Limits, RowsBeginWhereABaseCanStillStop) {
  ControllerParams p;
  p.collision.braking.enabled = true;
  p.collision.braking.reaction = 0.1;
  p.collision.object = {true, 0.3, 0.05, 0.6};
  int widened = 0;
  for (const auto& model : built_robots()) {
    const ControllerParams full = resolved(p, *model);
    const DamperParams& rows = full.collision.object;
    const VectorX all = VelocityBounds(*model, full, 0.02).speed();
    for (int i = 0; i + 1 < model->base_dof(); ++i) EXPECT_EQ(all[i], model->velocity_limits()[i]) << model->name;
    EXPECT_EQ(bounded_speed(*model, full), model->base.max_linear) << model->name;
    if (model->base_dof() == 0) {
      EXPECT_EQ(rows.influence, 0.3) << model->name;
      continue;
    }
    double way = 0.1 * model->base.max_linear;
    constexpr double h = 1e-5;
    for (double v = model->base.max_linear; v > 0.0; v -= model->base.max_acceleration[0] * h) way += h * v;
    EXPECT_NEAR(rows.influence - rows.stop, std::max(way, 0.25), 1e-4) << model->name;
    EXPECT_NEAR(rows.gain / (rows.influence - rows.stop), 0.6 / 0.25, 1e-12) << model->name;
    widened += rows.influence > 0.3;
    ControllerParams unaware = p;
    unaware.collision.braking.enabled = false;
    EXPECT_EQ(resolved(unaware, *model).collision.object.influence, 0.3) << model->name;
  }
  EXPECT_GT(widened, 0);
}

TEST(Limits, DampersOfBothEndsThatCrossBecomeTheirMean) {
  JointLimitParams law;
  law.method = JointLimitMethod::kDamper;
  law.influence = 0.5;
  law.stop = 0.2;
  const auto model = two_joints(0.0, 0.3);
  // At 0.1: high = (0.2 - 0.2)/0.3 = 0, low = -(0.1 - 0.2)/0.3 = 1/3; they cross, and meet at 1/6.
  const Bounds b = bounds_at(law, 0.1, model);
  EXPECT_NEAR(b.low, 1.0 / 6, 1e-12);
  EXPECT_NEAR(b.high, 1.0 / 6, 1e-12);
  law.gain = 100.0;  // the mean of 0 and 100/3 is far above the speed limit
  EXPECT_NEAR(bounds_at(law, 0.1, model).low, 2.0, 1e-12);
  EXPECT_NEAR(bounds_at(law, 0.1, model).high, 2.0, 1e-12);
  for (double q = -0.5; q < 0.8; q += 0.01) {
    const Bounds all = bounds_at(law, q, model);
    EXPECT_LE(all.low, all.high) << q;
    EXPECT_GE(all.low, -2.0);
    EXPECT_LE(all.high, 2.0);
  }
}

TEST(Limits, ContinuousJointsKeepTheirSpeedAlone) {
  for (const JointLimitMethod method :
       {JointLimitMethod::kNone, JointLimitMethod::kSource, JointLimitMethod::kDamper, JointLimitMethod::kBraking}) {
    JointLimitParams law;
    law.method = method;
    for (const double q : {0.0, 10.0, -1e6}) {
      EXPECT_EQ(bounds_at(law, q, two_joints(), 1).low, -3.0);
      EXPECT_EQ(bounds_at(law, q, two_joints(), 1).high, 3.0);
    }
  }
  JointLimitParams none;
  none.method = JointLimitMethod::kNone;
  EXPECT_EQ(bounds_at(none, 5.0).high, 2.0);
}

TEST(Limits, AccelerationIsClippedIntoThePositionBounds) {
  const auto model = two_joints();
  ControllerParams p;
  p.acceleration_limit.resize(2);
  p.acceleration_limit << 5.0, kInfinity;
  const VelocityBounds bounds(*model, resolved(p, *model), 0.02);
  EXPECT_TRUE(bounds.has_soft_acceleration());
  const auto at = [&](double measured, double hard_low, double hard_high) {
    VectorX v(2), low(2), high(2), a(2), b(2);
    v << measured, 1.0;
    low << hard_low, -3;
    high << hard_high, 3;
    bounds.acceleration(v, low, high, a, b);
    EXPECT_EQ(a[1], -3);
    EXPECT_EQ(b[1], 3);
    return Bounds{a[0], b[0]};
  };
  EXPECT_NEAR(at(0.5, -2, 2).low, 0.4, 1e-12);
  EXPECT_NEAR(at(0.5, -2, 2).high, 0.6, 1e-12);
  EXPECT_NEAR(at(1.95, -2, 2).high, 2.0, 1e-12);
  EXPECT_NEAR(at(1.95, -2, 0.3).low, 0.3, 1e-12) << "too fast for the limit: slow down at once";
  EXPECT_NEAR(at(1.95, -2, 0.3).high, 0.3, 1e-12);
  EXPECT_NEAR(at(-1.0, 0.1, 2).high, 0.1, 1e-12);
  ControllerParams none;
  EXPECT_FALSE(VelocityBounds(*model, resolved(none, *model), 0.02).has_soft_acceleration());
}

TEST(ErrorNorm, Kinds) {
  Vector6 e;
  e << 0.0, 0.6, 0.8, 3.0, 0.0, -4.0;
  EXPECT_NEAR(error_norm({.kind = ErrorNormKind::kEuclidean}, e), 5.0, 1e-12);
  EXPECT_NEAR(error_norm({.kind = ErrorNormKind::kL1}, e), 7.0, 1e-12);
  EXPECT_NEAR(error_norm({.kind = ErrorNormKind::kPose, .scale = 12.0}, e), 13.0, 1e-12);
}

TEST(Servo, ClampsKeepTheDirectionAndLeaveTheFeedForwardAlone) {
  Vector6 e, V;
  e << 0.0, 0.0, 2.0, 3.0, 4.0, 0.0;
  V << 5.0, 0.0, 0.0, 0.0, 0.0, 6.0;
  const Vector6 nu = servo_twist({.position = 2, .orientation = 0.5, .max_linear = 1.0, .max_angular = 0.4}, e, V);
  Vector6 expected;
  expected << 5.0, 0.0, 0.4, 0.6, 0.8, 6.0;
  EXPECT_LT((nu - expected).norm(), 1e-12);
  const Vector6 free = servo_twist({.position = 2, .orientation = 0.5}, e, Vector6::Zero());
  expected << 0.0, 0.0, 1.0, 6.0, 8.0, 0.0;
  EXPECT_LT((free - expected).norm(), 1e-12);
  EXPECT_EQ(servo_twist({}, Vector6::Zero(), Vector6::Zero()), Vector6::Zero());
}

TEST(Servo, BearingIsSeenFromTheBase) {
  EXPECT_NEAR(bearing(pose(1, 2, 0, 0, 0, kPi / 2), {1, 3, 5}), 0.0, 1e-12) << "straight ahead, whatever the height";
  EXPECT_NEAR(bearing(pose(1, 2, 0, 0, 0, kPi / 2), {0, 2, 1}), kPi / 2, 1e-12) << "to the left";
}

}  // namespace
}  // namespace moma
