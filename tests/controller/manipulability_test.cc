#include "controller/model/manipulability.h"

#include <gtest/gtest.h>

#include "tests/support/finite_difference.h"
#include "tests/support/no_alloc.h"
#include "tests/support/robots.h"

namespace moma {
namespace {

constexpr ManipulabilityRows kAllRows[] = {ManipulabilityRows::kTranslation, ManipulabilityRows::kRotation,
                                           ManipulabilityRows::kAll};

Eigen::VectorXi prismatic_flags(const RobotModel& model) {
  Eigen::VectorXi flags(model.num_joints());
  for (int i = 0; i < model.num_joints(); ++i)
    flags[i] = model.joints[static_cast<std::size_t>(i)].type == JointType::kPrismatic ? 1 : 0;
  return flags;
}

class ManipulabilityOf : public testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<const RobotModel> model_ = test::load_model(GetParam());
};

INSTANTIATE_TEST_SUITE_P(Robots, ManipulabilityOf, testing::ValuesIn(test::all_robots()),
                         [](const auto& robot) { return test::test_name(robot.param); });

TEST_P(ManipulabilityOf, GradientIsTheDerivative) {
  std::mt19937 engine(21);
  Kinematics kinematics(model_);
  const Eigen::VectorXi prismatic = prismatic_flags(*model_);
  const int n = model_->num_joints();
  int checked = 0;
  for (int trial = 0; trial < 10; ++trial) {
    const test::State state = test::random_state(*model_, engine);
    for (const ManipulabilityRows rows : kAllRows) {
      const auto value = [&](const VectorX& q) {
        kinematics.update(state.base, q);
        const Matrix6X arm = kinematics.J_WE_W().rightCols(n);
        return manipulability(arm, rows);
      };
      kinematics.update(state.base, state.q);
      const Matrix6X arm = kinematics.J_WE_W().rightCols(n);
      VectorX gradient(n);
      const Manipulability m = manipulability_gradient(arm, prismatic, rows, gradient);
      EXPECT_DOUBLE_EQ(m.value, value(state.q));
      if (m.value < 1e-3) continue;  // differences lose their digits near a singularity
      ++checked;
      VectorX numeric(n);
      const double h = test::difference_step();
      for (int i = 0; i < n; ++i) {
        const VectorX step = h * VectorX::Unit(n, i);
        numeric[i] = (value(state.q + step) - value(state.q - step)) / (2.0 * h);
      }
      EXPECT_LT((gradient - numeric).norm(), 1e-6 * numeric.norm() + 1e-9) << "rows " << static_cast<int>(rows);
    }
  }
  EXPECT_GE(checked, 10);
}

TEST(Manipulability, MatchesTheDeterminant) {
  for (int i = 0; i < 20; ++i) {
    const Matrix6X J = Matrix6X::Random(6, 8);
    const Matrix3X Jv = J.bottomRows<3>();
    const Matrix3X Jw = J.topRows<3>();
    EXPECT_NEAR(manipulability(J, ManipulabilityRows::kTranslation), std::sqrt((Jv * Jv.transpose()).determinant()),
                1e-12);
    EXPECT_NEAR(manipulability(J, ManipulabilityRows::kRotation), std::sqrt((Jw * Jw.transpose()).determinant()),
                1e-12);
    EXPECT_NEAR(manipulability(J, ManipulabilityRows::kAll), std::sqrt((J * J.transpose()).determinant()), 1e-11);
  }
}

TEST(Manipulability, SingularityGivesZeroAndAFlag) {
  Kinematics kinematics(test::load_model("configs/robots/ur5.yaml"));
  const RobotModel& model = kinematics.model();
  kinematics.update(Vector3::Zero(), VectorX::Zero(6));  // stretched arm, aligned wrist
  VectorX gradient = VectorX::Constant(6, 9.0);
  const Manipulability m =
      manipulability_gradient(kinematics.J_WE_W(), prismatic_flags(model), ManipulabilityRows::kAll, gradient);
  EXPECT_TRUE(m.singular);
  EXPECT_LT(m.value, 1e-9);
  EXPECT_EQ(gradient, VectorX::Zero(6));
}

TEST(Manipulability, FewJointsOrNoMotionAreSingular) {
  for (const Eigen::Index n : {0, 1, 2, 5}) {
    const Matrix6X J = Matrix6X::Random(6, n);
    VectorX gradient = VectorX::Constant(n, 9.0);
    const auto flags = Eigen::VectorXi::Zero(n).eval();
    EXPECT_EQ(manipulability(J, ManipulabilityRows::kAll), 0.0);
    EXPECT_TRUE(manipulability_gradient(J, flags, ManipulabilityRows::kAll, gradient).singular);
    EXPECT_EQ(gradient.sum(), 0.0);
  }
  const Matrix6X zero = Matrix6X::Zero(6, 7);
  VectorX gradient(7);
  EXPECT_TRUE(
      manipulability_gradient(zero, Eigen::VectorXi::Zero(7), ManipulabilityRows::kTranslation, gradient).singular);
  EXPECT_TRUE(gradient.allFinite());
}

TEST(Manipulability, NeverNaNForNaN) {
  Matrix6X J = Matrix6X::Random(6, 7);
  J(4, 2) = std::numeric_limits<double>::quiet_NaN();
  VectorX gradient(7);
  const Manipulability m = manipulability_gradient(J, Eigen::VectorXi::Zero(7), ManipulabilityRows::kAll, gradient);
  EXPECT_TRUE(m.singular);
  EXPECT_EQ(m.value, 0.0);
  EXPECT_EQ(gradient, VectorX::Zero(7));
}

TEST(Manipulability, DoesNotAllocate) {
  const Matrix6X J = Matrix6X::Random(6, 7);
  const auto flags = Eigen::VectorXi::Zero(7).eval();
  VectorX gradient(7);
  double sum = 0.0;
  const test::NoAlloc guard;
  for (const ManipulabilityRows rows : kAllRows) {
    sum += manipulability(J, rows);
    sum += manipulability_gradient(J, flags, rows, gradient).value;
  }
  EXPECT_EQ(guard.count(), 0) << sum;
}

}  // namespace
}  // namespace moma
