// The base first, then the arm; and servoing by roll, pitch and yaw.
#include "controller/task/servo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controller/controller_core.h"
#include "tests/controller/qp_robots.h"

namespace moma {
namespace {

using namespace test;

MobileBase base_of(BaseType type) {
  MobileBase base;
  base.type = type;
  base.max_linear = 0.8;
  base.max_angular = 1.2;
  return base;
}

TEST(Separate, TheBaseComesToStandBeforeTheGoal) {
  const BaseFirstParams params{.enabled = true};
  Rng rng(7);
  for (const BaseType type : {BaseType::kDifferential, BaseType::kOmnidirectional}) {
    for (int trial = 0; trial < 50; ++trial) {
      const Vector3 goal(uniform(rng, -4, 4), uniform(rng, -4, 4), 0.6);
      Vector3 base(uniform(rng, -1, 1), uniform(rng, -1, 1), uniform(rng, -3, 3));
      int steps = 0;
      for (; steps < 2000; ++steps) {
        const DriveIntoReach drive = drive_into_reach(params, base_of(type), base, goal);
        if (!drive.driving) break;
        ASSERT_LE(drive.velocity_B.head<2>().norm(), 0.8 + 1e-12);
        ASSERT_LE(std::abs(drive.velocity_B.z()), 1.2);
        if (type == BaseType::kDifferential) {
          ASSERT_EQ(drive.velocity_B.y(), 0.0);
        }
        const double c = std::cos(base.z()), s = std::sin(base.z());
        const Vector3& v = drive.velocity_B;
        base += 0.01 * Vector3(c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z());
      }
      ASSERT_LT(steps, 2000) << "never stands";
      const Vector2 way = goal.head<2>() - base.head<2>();
      EXPECT_NEAR(way.norm(), params.reach, params.tolerance);
      EXPECT_NEAR(std::remainder(std::atan2(way.y(), way.x()) - base.z(), 2 * M_PI), 0.0, params.bearing);
      EXPECT_EQ(drive_into_reach(params, base_of(type), base, goal).velocity_B, Vector3::Zero());
    }
  }
  EXPECT_FALSE(drive_into_reach(params, base_of(BaseType::kFixed), Vector3::Zero(), Vector3(5, 0, 0)).driving);
}

TEST(Separate, OnePartAtATime) {
  const auto model = frankie();
  ControllerParams p;
  p.base_first.enabled = true;
  p.collision.object.enabled = p.collision.floor.enabled = p.collision.self.enabled = false;
  ControllerCore controller(model, p, 0.02);
  StepResult result;
  controller.prepare(result);
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(model->num_velocities());
  Kinematics kinematics(model);
  kinematics.update(Vector3::Zero(), model->ready);
  o.goal.X_WG = kinematics.X_WE();
  o.goal.X_WG.translation() += Vector3(2.0, 0.3, -0.2);
  controller.step(o, result);
  EXPECT_GT(result.command[0], 0.1);
  EXPECT_EQ(result.command.tail(model->num_joints()), VectorX::Zero(model->num_joints())) << "the arm rests";
  o.base = Vector3(o.goal.X_WG.translation().x() - p.base_first.reach, o.goal.X_WG.translation().y(), 0.0);
  controller.step(o, result);
  EXPECT_EQ(result.status, StepStatus::kSolved);
  EXPECT_EQ(result.command.head(2), VectorX::Zero(2)) << "the base stands";
  EXPECT_GT(result.command.tail(model->num_joints()).norm(), 0.05);
  EXPECT_LT(controller.kkt_residual(), 1e-6);
}

TEST(Separate, WhatDoesNotGoWithItIsRefused) {
  const auto model = frankie();
  ControllerParams p;
  p.base_first.enabled = true;
  p.method = Method::kRrmc;
  EXPECT_THROW(ControllerCore(model, p, 0.02), std::invalid_argument);
  p.method = Method::kQp;
  p.plan.enabled = true;
  EXPECT_THROW(ControllerCore(model, p, 0.02), std::invalid_argument);
}

TEST(Rpy, IsWhatEigenTurnsBack) {
  const auto turned = [](const Vector3& rpy) -> Matrix3 {
    return (Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
            Eigen::AngleAxisd(rpy.x(), Vector3::UnitX()))
        .toRotationMatrix();
  };
  Rng rng(3);
  for (int trial = 0; trial < 500; ++trial) {
    const Vector3 rpy(uniform(rng, -3.1, 3.1), uniform(rng, -1.55, 1.55), uniform(rng, -3.1, 3.1));
    EXPECT_LT((rpy_of(turned(rpy)) - rpy).norm(), 1e-9) << rpy.transpose();
    for (const double upright : {-0.5 * std::numbers::pi, 0.5 * std::numbers::pi}) {
      const Matrix3 R = turned({rpy.x(), upright, rpy.z()});
      EXPECT_LT((turned(rpy_of(R)) - R).norm(), 1e-9) << rpy.transpose();
    }
  }
}

TEST(Rpy, SmallErrorsAreRotationVectorsAndLargeOnesAreNot) {
  Rng rng(5);
  const auto turned = [&](double angle) {
    Isometry X = Isometry::Identity();
    X.linear() =
        Eigen::AngleAxisd(angle, Vector3(uniform(rng, -1, 1), uniform(rng, -1, 1), 1).normalized()).toRotationMatrix();
    X.translation() = Vector3(uniform(rng, -1, 1), 0.2, uniform(rng, -1, 1));
    return X;
  };
  for (int trial = 0; trial < 50; ++trial) {
    const Isometry X_WE = turned(uniform(rng, -3, 3));
    Isometry X_WG = X_WE * turned(1e-4);
    EXPECT_LT((pose_error_rpy(X_WE, X_WG) - pose_error(X_WE, X_WG)).norm(), 2e-8);
    X_WG = X_WE * turned(1.2);
    const Vector6 error = pose_error_rpy(X_WE, X_WG);
    EXPECT_GT((error - pose_error(X_WE, X_WG)).norm(), 1e-3);
    EXPECT_EQ(error.tail<3>(), Vector3(X_WG.translation() - X_WE.translation()));
    // Seen from E its parts are the angles by which Rz Ry Rx comes to the goal.
    const Vector3 rpy = X_WE.linear().transpose() * error.head<3>();
    const Matrix3 R = (Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
                       Eigen::AngleAxisd(rpy.x(), Vector3::UnitX()))
                          .toRotationMatrix();
    EXPECT_LT((X_WE.linear() * R - X_WG.linear()).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace moma
