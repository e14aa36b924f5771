#include "controller/model/statics.h"

#include <gtest/gtest.h>

#include "tests/support/finite_difference.h"
#include "tests/support/robots.h"
#include "tests/support/tiny_robot.h"

namespace moma::test {
namespace {

constexpr double kGravity = 9.81;

double potential_energy(const RobotModel& model, const Kinematics& at) {
  double energy = 0.0;
  for (std::size_t l = 1; l < model.links.size(); ++l) {
    const auto& inertial = model.links[l].inertial;
    if (inertial) energy += kGravity * inertial->mass * (at.X_WL(static_cast<int>(l)) * inertial->com_L).z();
  }
  return energy;
}

class Statics : public ::testing::TestWithParam<std::string> {};

TEST_P(Statics, HoldingEffortsAreTheGradientOfThePotentialEnergy) {
  const auto model = load_model(GetParam());
  Kinematics kinematics(model);
  std::mt19937 engine(4);
  for (int i = 0; i < 20; ++i) {
    const State state = random_state(*model, engine);
    const MatrixX gradient = differentiate(
        *model, state,
        [&](const State& s) {
          kinematics.update(s.base, s.q);
          return potential_energy(*model, kinematics);
        },
        [](double a, double b) { return VectorX::Constant(1, a - b); });
    kinematics.update(state.base, state.q);
    const VectorX efforts = holding_efforts(kinematics);
    EXPECT_LT((gradient.row(0).tail(model->num_joints()).transpose() - efforts).cwiseAbs().maxCoeff(), 1e-6)
        << efforts.transpose();
    EXPECT_LT(gradient.row(0).head(model->base_dof()).norm(), 1e-9) << "driving on the floor lifts nothing";
  }
}

INSTANTIATE_TEST_SUITE_P(Robots, Statics, ::testing::ValuesIn(shipped_robots()),
                         [](const auto& robot) { return test_name(robot.param); });

// By hand: 2 kg at 0.1 m behind the bend, 1 kg at the slide's frame, 0.3 m behind it; the bend turns about y, down for
// positive angles.
std::shared_ptr<const RobotModel> weighted(double effort) {
  RobotModel model = *tiny_robot();
  model.links[3].inertial = Inertial{2.0, Vector3(0.1, 0, 0), Matrix3::Identity()};
  model.links[4].inertial = Inertial{1.0, Vector3::Zero(), Matrix3::Identity()};
  model.joints[1].effort = effort;
  return std::make_shared<const RobotModel>(model);
}

TEST(Statics, ByHand) {
  Kinematics kinematics(weighted(50.0));
  EXPECT_NEAR(holding_efforts(kinematics)[1], -kGravity * (2.0 * 0.1 + 1.0 * 0.3), 1e-12);
  EXPECT_NEAR(holding_efforts(kinematics)[0], 0.0, 1e-12) << "about the vertical";
  EXPECT_NEAR(holding_efforts(kinematics)[2], 0.0, 1e-12) << "level";
  VectorX q(3);
  q << 0.3, 1.0, 0.2;
  kinematics.update(Vector3(1, 2, 3), q);
  EXPECT_NEAR(holding_efforts(kinematics)[1], -kGravity * (2.0 * 0.1 + 1.0 * 0.5) * std::cos(1.0), 1e-12);
  EXPECT_NEAR(holding_efforts(kinematics)[2], -kGravity * std::sin(1.0), 1e-12) << "the slide, down a slope";
}

TEST(Statics, LoadsFindWhatIsTooHeavy) {
  // At `ready` 4.9 Nm; 8.8 Nm with the slide out.
  const auto load_of = [](double effort) {
    for (const JointLoad& load : joint_loads(weighted(effort)))
      if (load.joint == 1) return load;
    return JointLoad{};
  };
  EXPECT_EQ(load_of(20.0).beyond, 0.0);
  EXPECT_NEAR(load_of(20.0).ready, kGravity * 0.5, 1e-12);
  const JointLoad sometimes = load_of(7.0);
  EXPECT_GT(sometimes.beyond, 0.05);
  EXPECT_LT(sometimes.beyond, 0.5);
  EXPECT_NEAR(sometimes.largest, kGravity * 0.9, 0.3);
  EXPECT_GT(sometimes.q_largest[2], 0.3) << "the slide is out";
  EXPECT_GT(load_of(3.0).ready, 3.0);
  RobotModel unknown = *weighted(0.0);
  for (const JointLoad& load : joint_loads(std::make_shared<const RobotModel>(unknown)))
    EXPECT_NE(load.joint, 1) << "no limit is known";
}

TEST(Statics, ShippedRobotsHoldThemselves) {
  for (const std::string& robot : shipped_robots())
    for (const JointLoad& load : joint_loads(load_model(robot)))
      EXPECT_LE(load.largest, load.limit) << robot << ", joint " << load.joint;
}

}  // namespace
}  // namespace moma::test
