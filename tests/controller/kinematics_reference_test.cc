// Forward kinematics, Jacobians, kinematic Hessians and manipulability against numbers that Pinocchio computed from the
// same URDFs.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "controller/model/kinematics.h"
#include "controller/model/manipulability.h"
#include "tests/support/robots.h"

namespace moma {
namespace {

using nlohmann::json;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

MatrixX matrix(const json& in, Eigen::Index rows) {
  const auto values = in.get<std::vector<double>>();
  return Eigen::Map<const RowMajor>(values.data(), rows, static_cast<Eigen::Index>(values.size()) / rows);
}

VectorX vector(const json& in) { return matrix(in, static_cast<Eigen::Index>(in.size())); }

TEST(KinematicsReference, AgreesWithPinocchio) {
  std::ifstream file(test::source_path("tests/data/kinematics_reference.json"));
  const json reference = json::parse(file);
  ASSERT_EQ(reference["robots"].size(), 5U);
  int hessians = 0;
  for (const json& robot : reference["robots"]) {
    const auto name = robot["file"].get<std::string>();
    const auto model = test::load_model(name);
    ASSERT_EQ(model->joints.size(), robot["joints"].size()) << name;
    for (std::size_t i = 0; i < model->joints.size(); ++i) EXPECT_EQ(model->joints[i].name, robot["joints"][i]);
    Kinematics kinematics(model);
    ASSERT_GE(robot["cases"].size(), 5U);
    Eigen::VectorXi prismatic(model->num_joints());
    for (int i = 0; i < model->num_joints(); ++i)
      prismatic[i] = model->joints[static_cast<std::size_t>(i)].type == JointType::kPrismatic ? 1 : 0;
    const Vector3 mount = model->base.X_BM.translation();  // the reference has none
    ASSERT_TRUE(model->base.X_BM.linear() == Matrix3::Identity() && (mount.isZero() || model->base_dof() == 0)) << name;
    for (const json& c : robot["cases"]) {
      kinematics.update(vector(c["base"]), vector(c["q"]));
      EXPECT_LT((kinematics.X_WE().translation() - mount - vector(c["position"])).norm(), 1e-10) << name;
      EXPECT_LT((kinematics.X_WE().linear() - matrix(c["rotation"], 3)).norm(), 1e-10) << name;
      EXPECT_LT((kinematics.J_WE_W() - matrix(c["jacobian"], 6)).lpNorm<Eigen::Infinity>(), 1e-10) << name;
      const Matrix6X arm = kinematics.J_WE_W().rightCols(model->num_joints());
      if (c.contains("hessian")) {
        const MatrixX hessian = matrix(c["hessian"], 6 * arm.cols());  // the derivative by joint j in rows 6 j ...
        ASSERT_EQ(hessian.cols(), arm.cols()) << name;
        for (Eigen::Index j = 0; j < arm.cols(); ++j)
          for (Eigen::Index i = 0; i < arm.cols(); ++i)
            EXPECT_LT((jacobian_derivative(arm, prismatic, i, j) - hessian.block<6, 1>(6 * j, i)).norm(), 1e-10)
                << name << " column " << i << " by joint " << j;
        ++hessians;
      }
      const json& m = c["manipulability"];
      EXPECT_NEAR(manipulability(arm, ManipulabilityRows::kTranslation), m["translation"].get<double>(), 1e-10) << name;
      EXPECT_NEAR(manipulability(arm, ManipulabilityRows::kRotation), m["rotation"].get<double>(), 1e-10) << name;
      EXPECT_NEAR(manipulability(arm, ManipulabilityRows::kAll), m["all"].get<double>(), 1e-10) << name;
    }
  }
  EXPECT_EQ(hessians, 15) << "three of every robot";
}

// The robots written for this project have the makers' kinematics: the same hand and flange as the foreign files.
TEST(KinematicsReference, ShippedPandaIsThePanda) {
  Kinematics ours(test::load_model("configs/robots/panda.yaml"));
  Kinematics theirs(test::load_model("configs/robots/examples/panda.yaml"));
  for (int i = 0; i < 5; ++i) {
    VectorX q = VectorX::Random(7);
    q[3] -= 1.5;
    q[5] += 1.5;
    ours.update(Vector3::Zero(), q);
    theirs.update(Vector3::Zero(), q);
    EXPECT_TRUE(ours.X_WE().isApprox(theirs.X_WE(), 1e-9));
  }
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(ours.model().joints[i].lower, theirs.model().joints[i].lower);
    EXPECT_EQ(ours.model().joints[i].upper, theirs.model().joints[i].upper);
    EXPECT_EQ(ours.model().joints[i].velocity, theirs.model().joints[i].velocity);
    EXPECT_EQ(ours.model().joints[i].effort, theirs.model().joints[i].effort);
  }
}

// Independent of any URDF: the product of the UR5's published Denavit-Hartenberg matrices.
TEST(KinematicsReference, ShippedUr5FollowsItsDhTable) {
  constexpr double kHalfPi = 1.5707963267948966;
  const double a[] = {0, -0.425, -0.39225, 0, 0, 0};
  const double d[] = {0.089159, 0, 0, 0.10915, 0.09465, 0.0823};
  const double alpha[] = {kHalfPi, 0, 0, kHalfPi, -kHalfPi, 0};
  Kinematics kinematics(test::load_model("configs/robots/ur5.yaml"));
  Kinematics theirs(test::load_model("configs/robots/examples/ur5.yaml"));
  for (int trial = 0; trial < 5; ++trial) {
    const VectorX q = 2.0 * VectorX::Random(6);
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    for (int i = 0; i < 6; ++i) {
      const double ct = std::cos(q[i]), st = std::sin(q[i]), ca = std::cos(alpha[i]), sa = std::sin(alpha[i]);
      Eigen::Matrix4d A;
      A << ct, -st * ca, st * sa, a[i] * ct, st, ct * ca, -ct * sa, a[i] * st, 0, sa, ca, d[i], 0, 0, 0, 1;
      T = T * A;
    }
    kinematics.update(Vector3::Zero(), q);
    EXPECT_LT((kinematics.X_WE().matrix() - T).norm(), 1e-12);
    // ROS turns the UR5's base by half a turn against the maker's frame, and its lengths are rounded a little.
    theirs.update(Vector3::Zero(), q);
    const Isometry turned = Eigen::AngleAxisd(2.0 * kHalfPi, Vector3::UnitZ()) * kinematics.X_WE();
    const Vector3 mount = theirs.model().base.X_BM.translation();
    EXPECT_LT((theirs.X_WE().translation() - mount - turned.translation()).norm(), 1e-3);
  }
}

}  // namespace
}  // namespace moma
