// The presets of configs/controllers: each loads and steps for every shipped robot, and is what its name promises.

#include <gtest/gtest.h>

#include <filesystem>

#include "controller/config/controller_file.h"
#include "controller/controller.h"
#include "tests/support/robots.h"
#include "tests/support/tiny_robot.h"

namespace moma {
namespace {

const std::vector<std::string> kPresets = {"rmmi",     "rrmc",   "park",          "baur",      "mmc",        "neo",
                                           "holistic", "source", "moma-reactive", "moma-safe", "moma-ahead", "moma"};

ControllerParams preset(const std::string& name, const RobotModel& model, double period = 0.02) {
  std::vector<std::string> warnings;
  const std::string file = test::source_path("configs/controllers/" + name + ".yaml");
  const ControllerParams p = config::read_controller(config::load_yaml(file), "controller", model, period, warnings);
  EXPECT_TRUE(warnings.empty()) << name << ": " << warnings.front();
  return p;
}

// The tip's pose at `ready`, moved by `by` and turned about z.
Isometry moved_tip(const std::shared_ptr<const RobotModel>& model, const Vector3& by, double turn) {
  const Kinematics kin(model);
  Isometry X = kin.X_WE();
  X.translation() += by;
  X.linear() = Eigen::AngleAxisd(turn, Vector3::UnitZ()) * X.linear();
  return X;
}

// Kinematic run: the commanded velocity is held exactly for one period. Returns the last result.
StepResult run(const std::shared_ptr<const RobotModel>& model, const ControllerParams& params, const Isometry& goal,
               int steps, double period) {
  Controller controller(model, params, period);
  StepResult r;
  controller.prepare(r);
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(model->num_velocities());
  o.goal.X_WG = goal;
  for (int i = 0; i < steps; ++i) {
    o.time = i * period;
    controller.step(o, r);
    EXPECT_TRUE(r.command.allFinite());
    EXPECT_NE(r.status, StepStatus::kInvalidInput);
    integrate(*model, o.base, o.q, r.command, period);
    o.qdot = r.command;
  }
  return r;
}

TEST(Presets, TheFolderHoldsExactlyThese) {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(test::source_path("configs/controllers")))
    found.push_back(entry.path().stem().string());
  std::sort(found.begin(), found.end());
  std::vector<std::string> wanted = kPresets;
  std::sort(wanted.begin(), wanted.end());
  EXPECT_TRUE(std::includes(found.begin(), found.end(), wanted.begin(), wanted.end()));
}

TEST(Presets, LoadAndStepForEveryRobot) {
  for (const std::string& robot : test::shipped_robots()) {
    const auto model = test::load_model(robot);
    for (const std::string& name : kPresets) {
      SCOPED_TRACE(name + " on " + robot);
      const StepResult r = run(model, preset(name, *model), moved_tip(model, {0.1, 0.05, -0.05}, 0.2), 25, 0.02);
      EXPECT_EQ(r.status, StepStatus::kSolved);
    }
  }
}

// As Stretch's telescope, whose parts have ranges of 0.13 m: the fastest of them is through a third of it in one step.
TEST(Presets, MomaWorksWhereSlidesAreShort) {
  RobotModel model = *test::tiny_robot();
  model.joints[2].lower = -0.03;
  model.joints[2].upper = 0.1;
  model.joints[2].velocity = 1.0;
  const auto shared = std::make_shared<const RobotModel>(model);
  for (const char* name : {"moma-reactive", "moma-safe", "moma-ahead", "moma"}) {
    SCOPED_TRACE(name);
    ControllerParams params;
    ASSERT_NO_THROW(params = preset(name, model));
    EXPECT_EQ(run(shared, params, moved_tip(shared, {0.1, 0.05, 0.0}, 0.2), 25, 0.02).status, StepStatus::kSolved);
  }
}

TEST(Presets, PeriodsOfThePublicationsAreAccepted) {
  const auto model = test::load_model("configs/robots/frankie.yaml");
  for (const std::string& name : kPresets)
    for (const double period : {0.001, 0.01, 0.02, 0.025, 0.05}) EXPECT_NO_THROW(preset(name, *model, period)) << name;
}

TEST(Presets, ReachTheirGoals) {
  const auto model = test::load_model("configs/robots/frankie.yaml");
  const Isometry near = moved_tip(model, {0.2, 0.15, -0.1}, 0.3);
  for (const std::string& name : kPresets) {
    const StepResult r = run(model, preset(name, *model), near, 1000, 0.02);
    EXPECT_LT(r.error.tail<3>().norm(), 0.02) << name;
    EXPECT_LT(r.error.head<3>().norm(), 0.05) << name;
  }
  for (const char* name : {"moma", "holistic"}) {
    const StepResult r = run(model, preset(name, *model), moved_tip(model, {2.0, 0.5, 0.0}, 0.5), 1500, 0.02);
    EXPECT_LT(r.error.tail<3>().norm(), 0.02) << name;
  }
}

TEST(Presets, PublishedGains) {
  const auto model = test::load_model("configs/robots/frankie.yaml");
  const ControllerParams h = preset("holistic", *model);
  EXPECT_EQ(h.error_norm.kind, ErrorNormKind::kL1);
  EXPECT_TRUE(h.base_weight.inverse_error && h.slack.weight.inverse_error);
  EXPECT_EQ(h.servo.position, 1.5);
  EXPECT_EQ(h.servo.orientation, 1.95);
  EXPECT_EQ(h.servo.max_linear, kInfinity);
  EXPECT_EQ(h.joint_limits.method, JointLimitMethod::kDamper);
  EXPECT_EQ(h.joint_limits.influence, 0.9);
  EXPECT_EQ(h.joint_limits.stop, 0.1);
  EXPECT_EQ(h.collision.object.influence, 0.3);
  EXPECT_EQ(h.collision.object.stop, 0.05);
  EXPECT_FALSE(h.collision.floor.enabled);
  // moma's gains move as better ones are found; what it stands for stays.
  const ControllerParams m = preset("moma", *model);
  EXPECT_FALSE(m.base_weight.inverse_error || m.slack.weight.inverse_error);
  EXPECT_TRUE(std::isfinite(m.servo.max_linear) && std::isfinite(m.servo.max_angular));
  EXPECT_TRUE(m.acceleration_limit.allFinite());
  EXPECT_TRUE(m.collision.object.enabled && m.collision.floor.enabled && m.collision.self.enabled);
  EXPECT_FALSE(preset("mmc", *model).collision.object.enabled);
  const ControllerParams s = preset("source", *model);
  EXPECT_GT(s.posture.weight, 0);
  EXPECT_GT(s.acceleration_weight.minCoeff(), 0);
  EXPECT_EQ(s.joint_limits.method, JointLimitMethod::kSource);
}

}  // namespace
}  // namespace moma
