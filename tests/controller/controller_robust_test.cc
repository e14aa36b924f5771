// Whatever comes in, the command is finite and inside its bounds, and the status says what was wrong.

#include <gtest/gtest.h>

#include "controller/controller_core.h"
#include "tests/controller/qp_robots.h"

namespace moma {
namespace {

using namespace test;

class Robust : public ::testing::Test {
 protected:
  void start(ControllerParams params, std::size_t objects, std::uint64_t seed = 21) {
    rng_.seed(seed);
    shapes_ = random_objects(rng_, objects);
    controller_ = std::make_unique<ControllerCore>(model_, std::move(params), 0.02);
    controller_->reset(shapes_);
    controller_->prepare(result_);
  }
  void step_and_check(const Observation& o, const std::string& what) {
    controller_->step(o, result_);
    ASSERT_TRUE(result_.command.allFinite()) << what;
    ASSERT_TRUE(result_.slack.allFinite()) << what;
    ASSERT_TRUE(result_.error.allFinite()) << what;
    ASSERT_TRUE(std::isfinite(result_.error_norm)) << what;
    ASSERT_TRUE(std::isfinite(result_.manipulability)) << what;
    ASSERT_FALSE(std::isnan(result_.least_distance)) << what;
    const VectorX limit = model_->velocity_limits();
    for (int i = 0; i < 9; ++i) ASSERT_LE(std::abs(result_.command[i]), limit[i]) << what << " velocity " << i;
  }

  std::shared_ptr<const RobotModel> model_ = frankie();
  std::vector<ObjectShape> shapes_;
  std::unique_ptr<ControllerCore> controller_;
  StepResult result_;
  Rng rng_;
};

TEST_F(Robust, NotANumberAnywhere) {
  for (const Method method : {Method::kQp, Method::kRrmc, Method::kPark, Method::kBaur}) {
    ControllerParams p;
    p.method = method;
    p.acceleration_limit = VectorX::Constant(9, 5.0);
    start(p, 3);
    const Observation good = random_observation(*model_, 3, rng_);
    for (const double bad : {std::nan(""), kInfinity, -kInfinity}) {
      const auto broken = [&](const char* what, auto change) {
        Observation o = good;
        change(o);
        step_and_check(o, what);
        EXPECT_EQ(result_.status, StepStatus::kInvalidInput) << what;
        EXPECT_EQ(result_.fallback, Fallback::kBrake) << what;
      };
      broken("time", [&](Observation& o) { o.time = bad; });
      for (int i = 0; i < 3; ++i) broken("base", [&](Observation& o) { o.base[i] = bad; });
      for (int i = 0; i < 7; ++i) broken("q", [&](Observation& o) { o.q[i] = bad; });
      for (int i = 0; i < 9; ++i) broken("qdot", [&](Observation& o) { o.qdot[i] = bad; });
      broken("goal position", [&](Observation& o) { o.goal.X_WG.translation().y() = bad; });
      broken("goal rotation", [&](Observation& o) { o.goal.X_WG.linear()(1, 1) = bad; });
      broken("goal twist", [&](Observation& o) { o.goal.V_WG_W[4] = bad; });
      broken("object position", [&](Observation& o) { o.objects[1].X_WO.translation().z() = bad; });
      broken("object twist", [&](Observation& o) { o.objects[2].V_WO_W[0] = bad; });
    }
    controller_->step(good, result_);
    EXPECT_NE(result_.status, StepStatus::kInvalidInput) << "the next good observation is taken as if nothing was";
  }
}

TEST_F(Robust, BrakingOnBadInputKeepsWhatBoundsAreKnown) {
  ControllerParams p;
  p.acceleration_limit = VectorX::Constant(9, 5.0);
  start(p, 0);
  Observation o = random_observation(*model_, 0, rng_);
  o.q = model_->ready;
  o.qdot.setConstant(0.5);
  o.goal.X_WG.translation().x() = NAN;
  step_and_check(o, "goal");
  EXPECT_LT((result_.command.array() - 0.4).abs().maxCoeff(), 1e-12) << "0.5 less 5 x 0.02";
  o.qdot[4] = NAN;
  step_and_check(o, "goal and qdot");
  EXPECT_EQ(result_.command[4], 0.0);
  EXPECT_NEAR(result_.command[3], 0.4, 1e-12);
}

TEST_F(Robust, WrongSizes) {
  start({}, 2);
  const Observation good = random_observation(*model_, 2, rng_);
  const auto broken = [&](const char* what, auto change) {
    Observation o = good;
    change(o);
    step_and_check(o, what);
    EXPECT_EQ(result_.status, StepStatus::kInvalidInput) << what;
  };
  broken("short q", [](Observation& o) { o.q.conservativeResize(6); });
  broken("no q", [](Observation& o) { o.q.resize(0); });
  broken("long qdot", [](Observation& o) { o.qdot = VectorX::Zero(10); });
  broken("no qdot", [](Observation& o) { o.qdot.resize(0); });
  broken("one object too few", [](Observation& o) { o.objects.pop_back(); });
  broken("one object too many", [](Observation& o) { o.objects.emplace_back(); });
  StepResult unprepared;
  controller_->step(good, unprepared);
  EXPECT_EQ(unprepared.status, StepStatus::kInvalidInput);
  EXPECT_EQ(unprepared.command.size(), 0);
}

TEST_F(Robust, AbsurdButFiniteNumbers) {
  for (const Method method : {Method::kQp, Method::kRrmc, Method::kPark, Method::kBaur}) {
    ControllerParams p;
    p.method = method;
    start(p, 2);
    const Observation good = random_observation(*model_, 2, rng_);
    for (const double size : {1e3, 1e6, 1e12, 1e100, 1e200, 1e308}) {
      for (const double sign : {1.0, -1.0}) {
        const double v = sign * size;
        const auto with = [&](const char* what, auto change) {
          Observation o = good;
          change(o);
          step_and_check(o, std::string(what) + " " + std::to_string(v));
        };
        with("base", [&](Observation& o) { o.base.setConstant(v); });
        with("q", [&](Observation& o) { o.q.setConstant(v); });
        with("qdot", [&](Observation& o) { o.qdot.setConstant(v); });
        with("goal", [&](Observation& o) { o.goal.X_WG.translation().setConstant(v); });
        with("goal twist", [&](Observation& o) { o.goal.V_WG_W.setConstant(v); });
        with("goal rotation", [&](Observation& o) { o.goal.X_WG.linear() *= v; });
        with("object", [&](Observation& o) { o.objects[0].X_WO.translation().setConstant(v); });
        with("object twist", [&](Observation& o) { o.objects[0].V_WO_W.setConstant(v); });
      }
    }
  }
}

TEST_F(Robust, ManyObjectsAllAround) {
  for (const int max_pairs : {0, 1, 30, 1000}) {
    ControllerParams p;
    p.collision.max_pairs = max_pairs;
    start(p, 200);
    for (int trial = 0; trial < 10; ++trial) {
      const Observation o = random_observation(*model_, 200, rng_, 0.7);
      step_and_check(o, "200 objects");
      EXPECT_NE(result_.status, StepStatus::kMaxIterations);
      EXPECT_NE(result_.status, StepStatus::kInvalidInput);
      EXPECT_LE(result_.rows, 8 + max_pairs);
    }
  }
}

TEST_F(Robust, CoincidentAndTouching) {
  start({}, 12);
  Kinematics kin(model_);
  for (int trial = 0; trial < 200; ++trial) {
    Observation o = random_observation(*model_, 12, rng_);
    kin.update(o.base, o.q);
    for (std::size_t i = 0; i < o.objects.size(); ++i) {
      const CollisionShape& shape = model_->shapes[i % model_->shapes.size()];
      const Isometry X = kin.X_WS(shape);
      o.objects[i].X_WO = X;  // the same frame exactly: centres and axes coincide
      if (trial % 3 == 1) o.objects[i].X_WO.translation() += shape.shape.size.x() * X.linear().col(0);
      if (trial % 3 == 2) o.objects[i].X_WO.translation() += 1e-12 * random_vector(rng_, 1.0);
    }
    step_and_check(o, "contact");
    EXPECT_NE(result_.status, StepStatus::kInvalidInput);
    EXPECT_NE(result_.status, StepStatus::kMaxIterations);
  }
}

TEST_F(Robust, SingularArmAndGoalReached) {
  start({}, 0);
  Observation o;
  o.q = VectorX::Zero(7);
  o.q[3] = -0.0698;
  o.qdot = VectorX::Zero(9);
  o.goal.X_WG = pose(3, 0, 1, 0, 0, 0);
  step_and_check(o, "stretched out");
  EXPECT_EQ(result_.status, StepStatus::kSolved);
  Kinematics kin(model_);
  kin.update(o.base, o.q);
  o.goal.X_WG = kin.X_WE();
  step_and_check(o, "at the goal");
  EXPECT_EQ(result_.status, StepStatus::kSolved);
  EXPECT_EQ(result_.error_norm, 0.001) << "clamped, so that no weight is infinite";
  o.goal.X_WG.linear() = kin.X_WE().linear() * Eigen::AngleAxisd(kPi, Vector3::UnitX()).toRotationMatrix();
  step_and_check(o, "half a turn away");
  EXPECT_NEAR(result_.error.head<3>().norm(), kPi, 1e-9);
}

TEST_F(Robust, ConstructionRefusesNonsense) {
  const auto refuses = [&](const char* key, auto change, double period = 0.02) {
    ControllerParams p;
    change(p);
    try {
      ControllerCore c(model_, p, period);
      ADD_FAILURE() << key << " was taken";
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find(key), std::string::npos) << e.what();
    }
  };
  refuses(
      "control_period", [](ControllerParams&) {}, 0.0);
  refuses(
      "control_period", [](ControllerParams&) {}, NAN);
  refuses("lambda_q", [](ControllerParams& p) { p.lambda_q = VectorX::Ones(3); });
  refuses("lambda_q", [](ControllerParams& p) { p.lambda_q = VectorX::Constant(7, -1.0); });
  refuses("servo.position", [](ControllerParams& p) { p.servo.position = NAN; });
  refuses("error_norm.min", [](ControllerParams& p) { p.error_norm.min = 0.0; });
  refuses("collision.stop", [](ControllerParams& p) { p.collision.object.stop = 0.4; });
  refuses(
      "joint_limits.margin", [](ControllerParams&) {}, 0.2);
  refuses("lambda_q", [](ControllerParams& p) {
    p.method = Method::kPark;
    p.lambda_q = VectorX::Zero(7);
  });
  EXPECT_THROW(ControllerCore(nullptr, {}, 0.02), std::invalid_argument);
}

}  // namespace
}  // namespace moma
