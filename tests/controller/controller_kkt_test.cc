// Every solved step meets the optimality conditions of its problem, whatever the robot, state, gains and objects.

#include <gtest/gtest.h>

#include "controller/controller_core.h"
#include "tests/controller/qp_robots.h"
#include "tests/support/solvers.h"

namespace moma {
namespace {

using namespace test;

double pick(Rng& rng, std::initializer_list<double> options) {
  return *(options.begin() + static_cast<std::ptrdiff_t>(rng() % options.size()));
}

ControllerParams random_params(const RobotModel& model, Rng& rng) {
  ControllerParams p;
  p.servo.position = uniform(rng, 0.3, 4.0);
  p.servo.orientation = uniform(rng, 0.3, 4.0);
  p.servo.max_linear = pick(rng, {0.5, 1.0, kInfinity});
  p.servo.max_angular = pick(rng, {0.7, 1.5, kInfinity});
  p.error_norm.kind = static_cast<ErrorNormKind>(rng() % 3);
  p.base_weight = rng() % 2 ? Weight{} : Weight{false, pick(rng, {0.01, 0.1, 1.0})};
  p.lambda_q = VectorX::NullaryExpr(model.num_joints(), [&] { return uniform(rng, 0.005, 0.1); });
  p.slack.weight = rng() % 2 ? Weight{} : Weight{false, pick(rng, {1.0, 100.0, 1000.0})};
  if (rng() % 4 == 0) p.slack.limit.setConstant(kInfinity);
  if (rng() % 3 == 0) p.tracking_band.setConstant(0.01);
  p.k_epsilon = pick(rng, {0.0, 0.5, 2.0});
  p.manipulability.weight = pick(rng, {0.0, 0.1, 1.0});
  p.manipulability.rows = static_cast<ManipulabilityRows>(rng() % 3);
  p.joint_limits.method = static_cast<JointLimitMethod>(rng() % 3);
  p.collision.max_pairs = static_cast<int>(pick(rng, {0, 3, 10, 30}));
  if (rng() % 2) p.acceleration_weight = VectorX::Constant(model.num_velocities(), pick(rng, {0.01, 0.5}));
  if (rng() % 2) p.posture.weight = pick(rng, {0.01, 0.3});
  if (rng() % 3 == 0) p.acceleration_limit = VectorX::Constant(model.num_velocities(), pick(rng, {2.0, 8.0}));
  if (rng() % 4 == 0) p.output_scaling.enabled = true;
  return p;
}

void expect_bounds(const ControllerCore& c, const StepResult& r, const Observation& o, int trial) {
  const VectorX limit = c.model().velocity_limits();
  ASSERT_TRUE(r.command.allFinite()) << "trial " << trial;
  for (int i = 0; i < r.command.size(); ++i) {
    EXPECT_LE(std::abs(r.command[i]), limit[i]) << "trial " << trial << " velocity " << i;
    if (r.fallback == Fallback::kNone || r.fallback == Fallback::kBrake) {
      EXPECT_GE(r.command[i], c.problem().lb[i]) << "trial " << trial << " velocity " << i;
      EXPECT_LE(r.command[i], c.problem().ub[i]) << "trial " << trial << " velocity " << i;
    }
  }
  if (c.params().joint_limits.method != JointLimitMethod::kSource) return;
  // The source's S+-, written out again: no joint may be driven further out than its margin allows.
  const int base = c.model().base_dof();
  for (int i = 0; i < c.model().num_joints(); ++i) {
    const ControlledJoint& j = c.model().joints[static_cast<std::size_t>(i)];
    if (std::isinf(j.upper)) continue;
    const double margin = std::min(0.3, (j.upper - j.lower) / 4);
    EXPECT_LE(r.command[base + i], j.velocity * std::min(1.0, (j.upper - o.q[i]) / margin) + 1e-12);
    EXPECT_GE(r.command[base + i], -j.velocity * std::min(1.0, (o.q[i] - j.lower) / margin) - 1e-12);
  }
}

TEST(ControllerKkt, OptimalOverRandomStatesAndGains) {
  Rng rng(1);
  int solved = 0, infeasible = 0, relaxed = 0, rows = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const auto model = built_robots()[rng() % 3];
    ControllerCore c(model, random_params(*model, rng), 0.02);
    const std::vector<ObjectShape> shapes = random_objects(rng, rng() % 12);
    c.reset(shapes);
    StepResult r;
    c.prepare(r);
    const Observation o = random_observation(*model, shapes.size(), rng);
    c.step(o, r);
    expect_bounds(c, r, o, trial);
    ASSERT_NE(r.status, StepStatus::kInvalidInput);
    ASSERT_NE(r.status, StepStatus::kMaxIterations) << "trial " << trial;
    rows = std::max(rows, r.rows);
    relaxed += r.fallback == Fallback::kRelaxed ? 1 : 0;
    (r.status == StepStatus::kSolved ? solved : infeasible) += 1;
    // The slack's cost of 1e6 puts multipliers of up to 1e6 into the relaxed stage: its residual scales with them.
    if (r.fallback == Fallback::kRelaxed) {
      EXPECT_LT(c.kkt_residual(), 1e-4) << "trial " << trial << " s " << c.outcome().collision_slack;
    } else if (r.fallback != Fallback::kBrake) {
      EXPECT_LT(c.kkt_residual(), 1e-7) << "trial " << trial << " robot " << model->name;
    }
  }
  EXPECT_GT(solved, 500);
  EXPECT_GT(infeasible, 10);
  EXPECT_GT(relaxed, 5);
  EXPECT_GT(rows, 12);
  RecordProperty("solved", solved);
  RecordProperty("infeasible", infeasible);
}

TEST(ControllerKkt, SolversAgree) {
  Rng rng(2);
  const std::vector<NamedSolver> all = solvers();
  if (all.size() < 2) GTEST_SKIP() << "only DAQP is installed";
  int compared = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const auto model = built_robots()[rng() % 3];
    const ControllerParams p = random_params(*model, rng);
    const std::vector<ObjectShape> shapes = random_objects(rng, rng() % 8);
    const Observation o = random_observation(*model, shapes.size(), rng);
    double cost = 0.0;
    StepResult first;
    for (std::size_t k = 0; k < all.size(); ++k) {
      ControllerCore c(model, p, 0.02, all[k].make);
      c.reset(shapes);
      StepResult r;
      c.prepare(r);
      c.step(o, r);
      const std::string where =
          std::string("trial ") + std::to_string(trial) + " " + all[k].name + " on " + model->name;
      if (k == 0) {
        first = r;
        cost = c.cost();
        continue;
      }
      ASSERT_EQ(r.status, first.status) << where << ": " << to_string(r.status) << " " << to_string(first.status);
      ASSERT_EQ(r.fallback, first.fallback) << where;
      if (r.fallback == Fallback::kBrake) continue;
      EXPECT_NEAR(c.cost(), cost, 1e-6 * std::max(1.0, std::abs(cost))) << where;
      if (r.fallback == Fallback::kNone) {
        EXPECT_LT(c.kkt_residual(), 1e-6) << where;
      }
      ++compared;
    }
  }
  EXPECT_GT(compared, 100);
}

TEST(ControllerKkt, SameBitsWhateverCameBefore) {
  Rng rng(3);
  const auto model = frankie();
  const std::vector<ObjectShape> shapes = random_objects(rng, 8);
  ControllerCore used(model, {}, 0.02);
  used.reset(shapes);
  StepResult a, b;
  used.prepare(a);
  for (int trial = 0; trial < 100; ++trial) {
    const Observation o = random_observation(*model, shapes.size(), rng);
    used.step(o, a);
    ControllerCore fresh(model, {}, 0.02);
    fresh.reset(shapes);
    fresh.prepare(b);
    fresh.step(o, b);
    ASSERT_EQ(a.command, b.command) << "trial " << trial;
    ASSERT_EQ(a.slack, b.slack) << "trial " << trial;
    ASSERT_EQ(a.status, b.status);
  }
}

}  // namespace
}  // namespace moma
