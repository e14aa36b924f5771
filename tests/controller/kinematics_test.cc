#include "controller/model/kinematics.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/finite_difference.h"
#include "tests/support/no_alloc.h"
#include "tests/support/robots.h"

namespace moma {
namespace {

constexpr double kPi = std::numbers::pi;

class KinematicsOf : public testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<const RobotModel> model_ = test::load_model(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Robots, KinematicsOf, testing::ValuesIn(test::all_robots()),
                         [](const auto& robot) { return test::test_name(robot.param); });

TEST_P(KinematicsOf, StartsAtReady) {
  const Kinematics kinematics(model_);
  EXPECT_EQ(kinematics.q(), model_->ready);
  EXPECT_EQ(kinematics.base(), Vector3::Zero());
  EXPECT_EQ(kinematics.J_WE_W().cols(), model_->num_velocities());
  EXPECT_TRUE(kinematics.X_WE().matrix().allFinite());
  EXPECT_EQ(static_cast<int>(model_->velocity_names().size()), model_->num_velocities());
  EXPECT_EQ(model_->velocity_limits().size(), model_->num_velocities());
  EXPECT_GT(model_->velocity_limits().minCoeff(), 0.0);
}

TEST_P(KinematicsOf, JacobianIsTheDerivativeOfThePose) {
  std::mt19937 engine(7);
  Kinematics kinematics(model_);
  for (int trial = 0; trial < 5; ++trial) {
    const test::State state = test::random_state(*model_, engine);
    const auto pose = [&](const test::State& s) {
      kinematics.update(s.base, s.q);
      return kinematics.X_WE();
    };
    const MatrixX numeric = test::differentiate(*model_, state, pose, test::pose_difference);
    kinematics.update(state.base, state.q);
    for (int j = 0; j < model_->num_velocities(); ++j) {
      EXPECT_LT((kinematics.J_WE_W().col(j) - numeric.col(j)).lpNorm<Eigen::Infinity>(), 1e-8)
          << model_->velocity_names()[static_cast<std::size_t>(j)] << " in trial " << trial;
    }
  }
}

TEST_P(KinematicsOf, PointJacobianIsTheDerivativeOfThePoint) {
  std::mt19937 engine(8);
  Kinematics kinematics(model_);
  Matrix3X J(3, model_->num_velocities());
  const Vector3 p_L(0.07, -0.11, 0.05);  // fixed to the link
  for (int link = 0; link < static_cast<int>(model_->links.size()); ++link) {
    const test::State state = test::random_state(*model_, engine);
    const auto point = [&](const test::State& s) -> VectorX {
      kinematics.update(s.base, s.q);
      return kinematics.X_WL(link) * p_L;
    };
    const MatrixX numeric =
        test::differentiate(*model_, state, point, [](const VectorX& a, const VectorX& b) { return VectorX(a - b); });
    const Vector3 p_W = point(state);
    J.setConstant(1e9);  // every column has to be written
    kinematics.point_jacobian(link, p_W, J);
    EXPECT_LT((J - numeric).lpNorm<Eigen::Infinity>(), 1e-8) << model_->links[static_cast<std::size_t>(link)].name;
  }
}

TEST_P(KinematicsOf, UpdatesWithoutAllocating) {
  std::mt19937 engine(9);
  Kinematics kinematics(model_);
  Matrix3X J(3, model_->num_velocities());
  const test::State state = test::random_state(*model_, engine);
  VectorX q = state.q;
  Vector3 base = state.base;
  const VectorX v = VectorX::Constant(model_->num_velocities(), 0.1);
  const test::NoAlloc guard;
  for (int i = 0; i < 10; ++i) {
    integrate(*model_, base, q, v, 0.01);
    kinematics.update(base, q);
    kinematics.point_jacobian(model_->tip, kinematics.X_WE().translation(), J);
  }
  EXPECT_EQ(guard.count(), 0);
}

TEST(AllocationCount, SeesAnAllocation) {
  if (!test::NoAlloc::works()) GTEST_SKIP() << "sanitizers bring their own malloc";
  const test::NoAlloc guard;
  VectorX v(1000);
  v.setZero();
  EXPECT_GT(guard.count(), 0) << v.sum();
}

TEST(Kinematics, FixedBaseHasNoBaseColumns) {
  const auto model = test::load_model("configs/robots/panda.yaml");
  EXPECT_EQ(model->base_dof(), 0);
  EXPECT_EQ(model->num_velocities(), 7);
  EXPECT_EQ(model->velocity_names().front(), "panda_joint1");
}

TEST(Kinematics, BaseNamesAndLimits) {
  const auto differential = test::load_model("configs/robots/frankie.yaml");
  EXPECT_EQ(differential->velocity_names()[0], "v");
  EXPECT_EQ(differential->velocity_names()[1], "omega");
  EXPECT_EQ(differential->velocity_limits()[0], 1.0);
  EXPECT_EQ(differential->velocity_limits()[1], 1.5);
  const auto omni = test::load_model("configs/robots/frankie_omni.yaml");
  EXPECT_EQ(omni->velocity_names()[1], "v_y");
  EXPECT_EQ(omni->velocity_limits()[1], 1.0);
  EXPECT_EQ(omni->velocity_limits()[2], 1.5);
}

TEST(Integrate, MatchesManySmallSteps) {
  std::mt19937 engine(10);
  for (const char* file : {"configs/robots/frankie.yaml", "configs/robots/frankie_omni.yaml"}) {
    const auto model = test::load_model(file);
    for (const double omega : {0.0, 1e-9, 1e-5, 0.3, -2.0, 7.0}) {
      const test::State state = test::random_state(*model, engine);
      VectorX v = VectorX::Random(model->num_velocities());
      v[model->base_dof() - 1] = omega;
      const double dt = 0.8;
      Vector3 base = state.base;
      VectorX q = state.q;
      integrate(*model, base, q, v, dt);
      const test::State fine = test::drive(*model, state, dt * v, 200000);
      EXPECT_LT((base - fine.base).lpNorm<Eigen::Infinity>(), 1e-9) << file << " omega " << omega;
      EXPECT_LT((q - fine.q).lpNorm<Eigen::Infinity>(), 1e-9);
    }
  }
}

TEST(Integrate, FullCircleComesBack) {
  const auto model = test::load_model("configs/robots/frankie.yaml");
  Vector3 base(1.0, -2.0, 0.4);
  VectorX q = model->ready;
  VectorX v = VectorX::Zero(9);
  v[0] = 0.7;
  v[1] = 2.0 * kPi / 3.0;
  integrate(*model, base, q, v, 3.0);
  EXPECT_NEAR(base.x(), 1.0, 1e-12);
  EXPECT_NEAR(base.y(), -2.0, 1e-12);
  EXPECT_NEAR(base.z(), 0.4 + 2.0 * kPi, 1e-12);  // phi is not wrapped
}

Matrix3 rotation(const Vector3& r) {
  const double angle = r.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, r / angle).toRotationMatrix() : Matrix3::Identity();
}

TEST(LogSo3, InvertsTheExponential) {
  std::mt19937 engine(11);
  std::normal_distribution<> normal;
  for (const double angle : {0.0, 1e-300, 1e-15, 1e-9, 1e-8, 1e-5, 0.1, 1.0, 3.0, kPi - 1e-5, kPi - 1e-9}) {
    for (int i = 0; i < 50; ++i) {
      const Vector3 axis = Vector3(normal(engine), normal(engine), normal(engine)).normalized();
      const Vector3 found = log_so3(rotation(angle * axis));
      EXPECT_LT((found - angle * axis).norm(), 1e-14 + 1e-14 / std::max(1e-3, 1.0 - angle / kPi))
          << "angle " << angle << " axis " << axis.transpose();
    }
  }
}

TEST(LogSo3, AtPiTheAxisIsChosenBySign) {
  for (const Vector3& axis : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1), Vector3(1, 2, 3).normalized(),
                              Vector3(1, -2, 0.5).normalized(), Vector3(0, 1, -1).normalized()}) {
    const Matrix3 R = 2.0 * axis * axis.transpose() - Matrix3::Identity();  // exactly half a turn
    EXPECT_LT((log_so3(R) - kPi * axis).norm(), 1e-7) << axis.transpose();
    EXPECT_LE(log_so3(R).norm(), kPi + 1e-15);
  }
}

TEST(LogSo3, NearPiBothSidesGiveTheirOwnSign) {
  const Vector3 axis = Vector3(0.2, -0.7, 0.4).normalized();
  EXPECT_LT((log_so3(rotation((kPi - 1e-6) * axis)) - (kPi - 1e-6) * axis).norm(), 1e-9);
  EXPECT_LT((log_so3(rotation((kPi + 1e-6) * axis)) + (kPi - 1e-6) * axis).norm(), 1e-9);
}

TEST(BasePose, TurnsAboutZ) {
  const Isometry X = base_pose({1.0, 2.0, kPi / 2});
  EXPECT_LT((X * Vector3(1, 0, 0.5) - Vector3(1, 3, 0.5)).norm(), 1e-15);
}

}  // namespace
}  // namespace moma
