#include "world/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controller/model/kinematics.h"

namespace moma {
namespace {

Isometry start_pose() {
  Isometry X = Isometry::Identity();
  X.linear() = Eigen::AngleAxisd(0.7, Vector3(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
  X.translation() = Vector3(0.4, -1.2, 0.8);
  return X;
}

/// Central difference of the pose, [angular; linear] at its origin.
Vector6 differenced(const Motion& motion, const Isometry& X_0, double t) {
  const double h = 1e-5;
  const Isometry a = evaluate(motion, X_0, t - h).X;
  const Isometry b = evaluate(motion, X_0, t + h).X;
  Vector6 out;
  out << log_so3(b.linear() * a.linear().transpose()) / (2.0 * h), (b.translation() - a.translation()) / (2.0 * h);
  return out;
}

void expect_twist(const Motion& motion, const std::vector<double>& times, const char* what) {
  for (const double t : times) {
    const MovingPose pose = evaluate(motion, start_pose(), t);
    EXPECT_LT((pose.V_W - differenced(motion, start_pose(), t)).norm(), 1e-7) << what << " at t = " << t;
    EXPECT_LT((pose.X.linear() * pose.X.linear().transpose() - Matrix3::Identity()).norm(), 1e-12) << what;
  }
}

PathMotion path() {
  PathMotion motion;
  motion.times = {0.5, 1.0, 2.5, 3.0};
  motion.positions = {{0, 0, 0}, {1, 0, 0.5}, {1, 2, 0}, {0, 0, 1}};
  for (const double angle : {0.0, 0.9, -2.0, 3.0})
    motion.quaternions.emplace_back(Eigen::AngleAxisd(angle, Vector3(0.2, 1.0, -0.4).normalized()));
  return motion;
}

SplineMotion spline() {
  SplineMotion motion;
  motion.times = {0.0, 0.7, 1.5, 2.0, 3.2};
  motion.positions = {{0, 0, 0}, {1, 0.5, 0.5}, {1.2, 2, 0}, {0, 1, 1}, {-1, 0, 0.2}};
  return motion;
}

TEST(Motion, TwistIsTheDerivativeOfThePose) {
  LinearMotion linear;
  linear.V_W << 0.3, -0.6, 0.2, 0.5, 0.1, -0.4;
  expect_twist(linear, {0.1, 1.0, 7.0}, "linear");
  expect_twist(path(), {0.2, 0.7, 1.1, 2.2, 2.9, 5.0}, "path");
  expect_twist(CircleMotion{{1.0, 0.5, -0.2}, {0.0, 0.6, 2.0}, -0.8}, {0.1, 2.0, 9.0}, "circle");
  expect_twist(spline(), {0.1, 0.69, 0.71, 1.4, 1.9, 3.1, 4.0}, "spline");
  expect_twist(StaticMotion{}, {0.1, 3.0}, "static");
}

TEST(Motion, CircleTurnsRigidlyAboutItsAxis) {
  const CircleMotion motion{{1.0, 0.5, 0.0}, {0.0, 0.0, 3.0}, 0.5};
  const Isometry X = evaluate(motion, start_pose(), std::numbers::pi).X;  // a quarter turn
  const Vector3 arm = start_pose().translation() - motion.center;
  EXPECT_LT((X.translation() - motion.center - Vector3(-arm.y(), arm.x(), arm.z())).norm(), 1e-12);
  EXPECT_LT((X.linear() - Eigen::AngleAxisd(std::numbers::pi / 2, Vector3::UnitZ()) * start_pose().linear()).norm(),
            1e-12);
}

TEST(Motion, SplinePassesItsKnotsWithContinuousTwistAndNaturalEnds) {
  const SplineMotion motion = spline();
  for (std::size_t i = 0; i < motion.times.size(); ++i)
    EXPECT_LT((evaluate(motion, start_pose(), motion.times[i]).X.translation() - motion.positions[i]).norm(), 1e-12);
  const double e = 1e-9;
  const auto v = [&](double t) -> Vector3 { return evaluate(motion, start_pose(), t).V_W.tail<3>(); };
  for (std::size_t i = 1; i + 1 < motion.times.size(); ++i)
    EXPECT_LT((v(motion.times[i] + e) - v(motion.times[i] - e)).norm(), 1e-6) << "knot " << i;
  // No curvature at the ends.
  EXPECT_LT((v(1e-6) - v(0.0)).norm() / 1e-6, 1e-4);
  EXPECT_LT((v(3.2 - 1e-9) - v(3.2 - 1e-6)).norm() / 1e-6, 1e-3);
}

TEST(Motion, PathIsHeldAtItsEnds) {
  const PathMotion motion = path();
  EXPECT_EQ(evaluate(motion, start_pose(), 0.0).X.translation(), motion.positions.front());
  EXPECT_EQ(evaluate(motion, start_pose(), 99.0).X.translation(), motion.positions.back());
  EXPECT_TRUE(evaluate(motion, start_pose(), 99.0).V_W.isZero(0.0));
  EXPECT_FALSE(at_rest(motion, 0.0));
  EXPECT_FALSE(at_rest(motion, 2.9));
  EXPECT_TRUE(at_rest(motion, 3.0));
}

TEST(Motion, RestIsSeen) {
  EXPECT_TRUE(at_rest(StaticMotion{}, 0.0));
  EXPECT_TRUE(at_rest(LinearMotion{}, 0.0));
  LinearMotion turning;
  turning.V_W[1] = 0.1;
  EXPECT_FALSE(at_rest(turning, 50.0));
  EXPECT_FALSE(at_rest(CircleMotion{{0, 0, 0}, {0, 0, 1}, 0.1}, 50.0));
  EXPECT_FALSE(at_rest(spline(), 1.0));
  EXPECT_TRUE(at_rest(spline(), 3.2));
}

}  // namespace
}  // namespace moma
