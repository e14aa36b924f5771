// States in which a formula has no value or a bound no room, for every preset on a fixed Panda, a fixed UR5 and
// Frankie: the answer is finite, inside its bounds, and the one that docs/explanation/controller.md ("Special states")
// describes.

#include <gtest/gtest.h>

#include "controller/config/controller_file.h"
#include "controller/controller_core.h"
#include "tests/support/control_period.h"
#include "tests/support/robots.h"

namespace moma {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;

const std::vector<std::string> kStepPresets = {"rrmc", "park", "baur", "mmc", "neo", "holistic", "source", "moma"};

class SpecialStates : public ::testing::TestWithParam<std::string> {
 protected:
  void load(const std::string& robot) {
    model_ = test::load_model("configs/robots/" + robot + ".yaml");
    std::vector<std::string> warnings;
    const std::string file = test::source_path("configs/controllers/" + GetParam() + ".yaml");
    params_ = config::read_controller(config::load_yaml(file), "controller", *model_, kPeriod, warnings);
    seen_ = Observation();
    seen_.q = model_->ready;
    seen_.qdot = VectorX::Zero(model_->num_velocities());
    shapes_.clear();
    look_ahead(Vector3(0.1, -0.2, 0.1));
  }
  // A goal moved from where the end effector is.
  void look_ahead(const Vector3& by) {
    Kinematics kinematics(model_);
    kinematics.update(seen_.base, seen_.q);
    seen_.goal.X_WG = kinematics.X_WE();
    seen_.goal.X_WG.translation() += by;
  }
  const StepResult& step(const std::string& what) {
    controller_ = std::make_unique<ControllerCore>(model_, params_, kPeriod);
    controller_->reset(shapes_);
    controller_->prepare(result_);
    controller_->step(seen_, result_);
    EXPECT_TRUE(result_.command.allFinite()) << what;
    EXPECT_TRUE(result_.slack.allFinite()) << what;
    EXPECT_TRUE(result_.error.allFinite()) << what;
    EXPECT_TRUE(std::isfinite(result_.manipulability)) << what;
    EXPECT_NE(result_.status, StepStatus::kInvalidInput) << what;
    EXPECT_NE(result_.status, StepStatus::kMaxIterations) << what;
    const VectorX limit = model_->velocity_limits();
    for (int i = 0; i < limit.size(); ++i) EXPECT_LE(std::abs(result_.command[i]), limit[i]) << what << ", " << i;
    return result_;
  }

  std::shared_ptr<const RobotModel> model_;
  ControllerParams params_;
  Observation seen_;
  std::vector<ObjectShape> shapes_;
  std::unique_ptr<ControllerCore> controller_;
  StepResult result_;
};

INSTANTIATE_TEST_SUITE_P(Presets, SpecialStates, ::testing::ValuesIn(kStepPresets),
                         [](const auto& preset) { return preset.param; });

TEST_P(SpecialStates, SingularStarts) {
  for (const ManipulabilityRows rows :
       {ManipulabilityRows::kTranslation, ManipulabilityRows::kRotation, ManipulabilityRows::kAll}) {
    load("ur5");
    params_.manipulability.rows = rows;
    seen_.q.setZero();  // stretched out, wrist aligned
    look_ahead(Vector3(0.2, 0.1, -0.1));
    step("UR5 stretched out");
    if (rows == ManipulabilityRows::kAll) {
      EXPECT_LT(result_.manipulability, 1e-9);
      EXPECT_EQ(controller_->J_m(), VectorX::Zero(6)) << "no gradient at a singularity";
    }
    // Lying 9 cm above the floor it is too near to it; getting away takes more than an acceleration bound allows. Where
    // that bound holds in every stage, the floor's rows give way to it.
    if (!params_.acceleration_limit.allFinite()) {
      EXPECT_EQ(result_.status, StepStatus::kSolved);
    } else {
      EXPECT_NE(result_.fallback, Fallback::kBrake);
    }

    load("panda");
    params_.manipulability.rows = rows;
    seen_.q[3] = 0.0;  // the elbow straight, which is beyond its upper limit of -0.0698
    look_ahead(Vector3(-0.2, 0.1, -0.1));
    EXPECT_EQ(step("Panda at q4 = 0").status, StepStatus::kSolved);
    if (params_.method == Method::kQp) {
      EXPECT_LE(result_.command[3], 0.0) << "only the way back is free";
    }
    seen_.q.setZero();
    look_ahead(Vector3(0.0, 0.0, 0.2));
    step("Panda straight up");
  }
}

TEST_P(SpecialStates, JointsAtAndBeyondTheirLimits) {
  for (const char* robot : {"panda", "ur5", "frankie"}) {
    load(robot);
    for (int i = 0; i < model_->num_joints(); ++i) {
      const ControlledJoint& joint = model_->joints[static_cast<std::size_t>(i)];
      if (std::isinf(joint.upper)) continue;
      for (const double over : {0.0, 1e-12, 0.01, 1.0, 100.0}) {
        for (const double side : {-1.0, 1.0}) {
          seen_.q = model_->ready;
          seen_.q[i] = side > 0 ? joint.upper + over : joint.lower - over;
          const std::string what = joint.name + (side > 0 ? " above by " : " below by ") + std::to_string(over);
          step(what);
          if (params_.method == Method::kQp && params_.joint_limits.method != JointLimitMethod::kNone) {
            EXPECT_LE(side * result_.command[model_->base_dof() + i], 0.0) << what << ": only the way back is free";
          }
        }
      }
    }
    for (int i = 0; i < model_->num_joints(); ++i) {
      const ControlledJoint& joint = model_->joints[static_cast<std::size_t>(i)];
      seen_.q[i] = std::isinf(joint.upper) ? 0.0 : joint.upper;
    }
    step("all joints at their limits");
  }
}

TEST_P(SpecialStates, OrientationErrorsNearHalfATurn) {
  load("panda");
  look_ahead(Vector3::Zero());
  const Matrix3 R = seen_.goal.X_WG.linear();
  for (const Vector3& axis :
       {Vector3::UnitX().eval(), Vector3::UnitY().eval(), Vector3::UnitZ().eval(), Vector3(1, -2, 0.5).normalized()}) {
    VectorX last;
    for (const double angle : {kHalfTurn - 1e-3, kHalfTurn - 1e-6, kHalfTurn - 1e-9, kHalfTurn - 1e-15, kHalfTurn}) {
      seen_.goal.X_WG.linear() = Eigen::AngleAxisd(angle, axis).toRotationMatrix() * R;
      step("half a turn");
      EXPECT_NEAR(result_.error.head<3>().norm(), angle, 1e-7);
      EXPECT_NEAR(std::abs(result_.error.head<3>().normalized().dot(axis)), 1.0, 1e-6) << angle;
      // Up to pi the error's direction is clear, and so is the command's; at pi itself both senses are as good.
      if (last.size() > 0 && angle < kHalfTurn - 1e-10) {
        EXPECT_LT((result_.command - last).norm(), 0.02) << angle;
      }
      last = result_.command;
    }
  }
}

TEST_P(SpecialStates, GoalAtThePresentPose) {
  for (const char* robot : {"panda", "ur5", "frankie"}) {
    load(robot);
    look_ahead(Vector3::Zero());
    step("at the goal");
    EXPECT_LT(result_.error.norm(), 1e-9);
    EXPECT_GE(result_.error_norm, params_.error_norm.min) << "clamped: no weight is infinite";
    EXPECT_EQ(result_.status, StepStatus::kSolved);
    if (params_.method == Method::kRrmc) {
      EXPECT_LT(result_.command.norm(), 1e-9) << "nothing left to do";
    }
  }
}

TEST_P(SpecialStates, ObjectsInContactInsideAndAtTheSamePoints) {
  for (const char* robot : {"panda", "frankie"}) {
    load(robot);
    Kinematics kinematics(model_);
    kinematics.update(seen_.base, seen_.q);
    for (const ShapeKind kind : {ShapeKind::kSphere, ShapeKind::kBox, ShapeKind::kCylinder, ShapeKind::kCapsule}) {
      for (const double offset : {0.0, 1e-13, 0.05}) {
        shapes_.clear();
        seen_.objects.clear();
        for (const CollisionShape& part : model_->shapes) {
          shapes_.push_back({"o", {kind, Vector3(0.05, kind == ShapeKind::kSphere ? 0.0 : 0.1, 0.1), nullptr}});
          ObjectState state;
          state.X_WO = kinematics.X_WS(part);
          state.X_WO.translation().x() += offset;
          seen_.objects.push_back(state);
        }
        step("objects inside every part");
      }
    }
  }
}

TEST_P(SpecialStates, TwoHundredObjects) {
  load("frankie");
  for (int i = 0; i < 200; ++i) {
    shapes_.push_back({std::string("o") + std::to_string(i), {ShapeKind::kSphere, Vector3(0.08, 0, 0), nullptr}});
    ObjectState state;
    const double turn = 0.6180339887498949 * 2.0 * kHalfTurn * i;
    const double radius = 0.6 + 0.01 * (i % 50);
    state.X_WO.translation() = Vector3(radius * std::cos(turn), radius * std::sin(turn), 0.1 + 0.007 * i);
    state.V_WO_W << 0, 0, 0, -0.1 * std::cos(turn), -0.1 * std::sin(turn), 0;
    seen_.objects.push_back(state);
  }
  step("200 objects");
  EXPECT_LE(result_.rows, 6 + params_.collision.max_pairs + 2);
}

}  // namespace
}  // namespace moma
