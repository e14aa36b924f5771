// Each stage of the fallback, built on purpose, and what every stage must keep.

#include <gtest/gtest.h>

#include "controller/controller_core.h"
#include "tests/controller/qp_robots.h"
#include "tests/support/solvers.h"

namespace moma {
namespace {

using namespace test;

class Fallbacks : public ::testing::TestWithParam<NamedSolver> {
 protected:
  void SetUp() override {
    params_.collision.floor.enabled = false;
    params_.collision.self.enabled = false;
    observation_.q = model_->ready;
    observation_.qdot = VectorX::Zero(9);
    Kinematics kin(model_);
    tip_ = kin.X_WE();
    observation_.goal.X_WG = tip_;
  }
  // A sphere whose surface is `gap` ahead of the tip's shape along x, moving at `speed` towards it.
  void put_object(double gap, double speed) {
    shapes_ = {{"ball", {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}}};
    Kinematics kin(model_);
    const CollisionShape& hand = model_->shapes.back();
    const Isometry X = kin.X_WS(hand);
    // The capsule lies along y: its surface towards +x is one radius from its centre.
    observation_.objects.resize(1);
    observation_.objects[0].X_WO.translation() = X.translation() + Vector3(hand.shape.size.x() + gap + 0.1, 0, 0);
    observation_.objects[0].V_WO_W.tail<3>() = Vector3(-speed, 0, 0);
  }
  const StepResult& step() {
    controller_ = std::make_unique<ControllerCore>(model_, params_, 0.02, GetParam().make);
    controller_->reset(shapes_);
    controller_->prepare(result_);
    controller_->step(observation_, result_);
    return result_;
  }

  std::shared_ptr<const RobotModel> model_ = frankie();
  ControllerParams params_;
  std::vector<ObjectShape> shapes_;
  Observation observation_;
  Isometry tip_;
  std::unique_ptr<ControllerCore> controller_;
  StepResult result_;
};

TEST_P(Fallbacks, NoneWhereSolved) {
  put_object(0.5, 0.0);
  EXPECT_EQ(step().status, StepStatus::kSolved);
  EXPECT_EQ(result_.fallback, Fallback::kNone);
}

TEST_P(Fallbacks, NoAcceleration) {
  // From rest, an acceleration bound allows 0.01 a step: too little to get out of a ball's way, which without the
  // bound is easy.
  put_object(0.1, 0.4);
  params_.acceleration_limit = VectorX::Constant(9, 0.5);
  EXPECT_EQ(step().status, StepStatus::kInfeasible);
  EXPECT_EQ(result_.fallback, Fallback::kNoAcceleration);
  EXPECT_LT(controller_->kkt_residual(), 1e-7);
  EXPECT_EQ(controller_->outcome().collision_slack, 0.0);
  // The rows hold, the acceleration bound does not.
  const QpProblem& p = controller_->problem();
  ASSERT_EQ(controller_->row_name(6).substr(0, 12), "object/ball/");
  EXPECT_LE(p.A.row(6).dot(controller_->solution().x.head(15)), p.ubA[6] + 1e-8);
  EXPECT_GT((result_.command - p.ub.head(9)).maxCoeff() + (p.lb.head(9) - result_.command).maxCoeff(), 1e-3);
  // Without the bound the same problem is solved as it is.
  params_.acceleration_limit.resize(0);
  EXPECT_EQ(step().status, StepStatus::kSolved);
}

TEST_P(Fallbacks, RelaxedWithOneCommonSlack) {
  put_object(0.02, 6.0);  // faster than any velocity limit lets the robot retreat
  EXPECT_EQ(step().status, StepStatus::kInfeasible);
  EXPECT_EQ(result_.fallback, Fallback::kRelaxed);
  const double s = controller_->outcome().collision_slack;
  EXPECT_GT(s, 0.1);
  // Every collision row holds with the one slack, and at least one needs all of it.
  const QpProblem& p = controller_->problem();
  double worst = -kInfinity;
  for (int r = 0; r < p.rows; ++r) {
    if (p.ids[static_cast<std::size_t>(r)].kind != RowKind::kObject) continue;
    worst = std::max(worst, p.A.row(r).dot(controller_->solution().x.head(15)) - p.ubA[r] - s);
  }
  EXPECT_NEAR(worst, 0.0, 1e-6);
  // Stationarity in s: its cost's slope, 1e6 s, is what the collision rows push back with together.
  double push = 0.0;
  for (int r = 0; r < p.rows; ++r)
    if (p.ids[static_cast<std::size_t>(r)].kind == RowKind::kObject) push += controller_->solution().row_multipliers[r];
  EXPECT_NEAR(push, 1e6 * s, 1e-6 * push);
  const VectorX limit = model_->velocity_limits();
  EXPECT_TRUE((result_.command.array().abs() <= limit.array()).all());
  EXPECT_LT(controller_->kkt_residual(), 1e-3);
  EXPECT_LT(result_.command[0], 0.0) << "the base retreats";
}

TEST_P(Fallbacks, RelaxedDropsAccelerationBoundsToo) {
  put_object(0.02, 6.0);
  params_.acceleration_limit = VectorX::Constant(9, 0.5);
  EXPECT_EQ(step().fallback, Fallback::kRelaxed);
  EXPECT_GT(result_.command.cwiseAbs().maxCoeff(), 0.5 * 0.02 + 1e-6);
}

TEST_P(Fallbacks, BrakeWhereNoRowCanBeRelaxed) {
  params_.slack.enabled = false;  // a hard equality that asks for 100 m/s
  observation_.goal.V_WG_W.tail<3>() = Vector3(100, 0, 0);
  EXPECT_EQ(step().status, StepStatus::kInfeasible);
  EXPECT_EQ(result_.fallback, Fallback::kBrake);
  EXPECT_EQ(result_.command, VectorX::Zero(9));
  EXPECT_EQ(result_.slack, Vector6::Zero());
}

TEST_P(Fallbacks, BrakeKeepsAccelerationBoundsAndJointLimits) {
  params_.slack.enabled = false;
  params_.acceleration_limit = VectorX::Constant(9, 2.0);
  observation_.goal.V_WG_W.tail<3>() = Vector3(100, 0, 0);
  observation_.qdot.setConstant(0.5);
  EXPECT_EQ(step().fallback, Fallback::kBrake);
  // Slower by a dt = 0.04 at once, no more; joints near a limit as far as S+- lets them.
  for (int i = 0; i < 9; ++i) {
    EXPECT_GE(result_.command[i], controller_->problem().lb[i]);
    EXPECT_LE(result_.command[i], controller_->problem().ub[i]);
    EXPECT_NEAR(result_.command[i], 0.46, 1e-12) << i;
  }
  // Beyond its upper limit a joint may only come back: S+ = 0 wins over the acceleration bound.
  observation_.q[1] = 1.8;
  step();
  EXPECT_EQ(result_.command[3], 0.0);
}

TEST_P(Fallbacks, DamperBeyondItsStopStillBrakesInsideItsBounds) {
  params_.slack.enabled = false;
  params_.joint_limits.method = JointLimitMethod::kDamper;
  observation_.q[1] = 1.75;  // 0.013 from its limit, stop 0.1: the damper wants it back
  observation_.goal.V_WG_W.tail<3>() = Vector3(100, 0, 0);
  EXPECT_EQ(step().fallback, Fallback::kBrake);
  EXPECT_LT(result_.command[3], 0.0) << "clip(0, lb, ub) with ub < 0";
  EXPECT_EQ(result_.command[3], controller_->problem().ub[3]);
}

INSTANTIATE_TEST_SUITE_P(Solvers, Fallbacks, ::testing::ValuesIn(solvers()),
                         [](const auto& solver) { return solver.param.name; });

TEST(Braking, ClipsZeroIntoAnyBounds) {
  EXPECT_EQ(braking(-1, 1), 0.0);
  EXPECT_EQ(braking(0.2, 1), 0.2);
  EXPECT_EQ(braking(-1, -0.3), -0.3);
  EXPECT_EQ(braking(-kInfinity, kInfinity), 0.0);
  EXPECT_EQ(braking(NAN, 1), 0.0);
  EXPECT_EQ(braking(-1, NAN), 0.0);
  EXPECT_EQ(braking(kInfinity, kInfinity), 0.0);
}

}  // namespace
}  // namespace moma
