// The closed-form baselines against their definitions, by another decomposition.

#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "controller/controller_core.h"
#include "controller/model/base_kind.h"
#include "tests/controller/qp_robots.h"

namespace moma {
namespace {

using namespace test;

MatrixX damped_inverse(const Matrix6X& J) {
  const Eigen::JacobiSVD<MatrixX> svd(J, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorX s = svd.singularValues();
  const double least = s.size() < 6 ? 0.0 : s.minCoeff();
  const double damping = least < 0.02 ? 0.05 * 0.05 * (1 - least * least / (0.02 * 0.02)) : 0.0;
  const VectorX inverse = s.array() / (s.array().square() + damping);
  return svd.matrixV() * inverse.asDiagonal() * svd.matrixU().transpose();
}

struct Answer {
  VectorX command;
  Matrix6X J;
  Vector6 nu;
  VectorX J_m;
};

Answer run(const std::shared_ptr<const RobotModel>& model, ControllerParams p, const Observation& o) {
  ControllerCore c(model, std::move(p), 0.02);
  StepResult r;
  c.prepare(r);
  c.step(o, r);
  EXPECT_EQ(r.status, StepStatus::kSolved);
  EXPECT_EQ(r.rows, 0);
  return {r.command, c.J(), c.nu(), c.J_m()};
}

// A slow servo, so that no limit scales the command.
ControllerParams slow(Method method) {
  ControllerParams p;
  p.method = method;
  p.servo = {0.02, 0.02, kInfinity, kInfinity};
  p.manipulability.weight = 0.02;
  p.lambda_q = VectorX();
  return p;
}

TEST(ClosedForm, RrmcIsTheDampedPseudoinverse) {
  Rng rng(41);
  int damped = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const auto model = built_robots()[rng() % 3];
    Observation o = random_observation(*model, 0, rng);
    o.goal.V_WG_W.setZero();
    if (model->name == "panda" && trial % 2 == 0) o.q.head(3).setZero(), o.q[4] = 0, o.q[5] = uniform(rng, 0, 0.02);
    const Answer r = run(model, slow(Method::kRrmc), o);
    damped += Eigen::JacobiSVD<MatrixX>(r.J).singularValues().minCoeff() < 0.02 ? 1 : 0;
    EXPECT_LT((r.command - damped_inverse(r.J) * r.nu).lpNorm<Eigen::Infinity>(), 1e-8) << model->name;
  }
  EXPECT_GT(damped, 10);
}

TEST(ClosedForm, ParkAndBaurAddProjectedGradients) {
  Rng rng(42);
  for (int trial = 0; trial < 200; ++trial) {
    const auto model = built_robots()[rng() % 3];
    Observation o = random_observation(*model, 0, rng);
    o.goal.V_WG_W.setZero();
    const int base = model->base_dof();
    const Answer rrmc = run(model, slow(Method::kRrmc), o);
    const Answer park = run(model, slow(Method::kPark), o);
    const MatrixX inverse = damped_inverse(park.J);
    const MatrixX projector = MatrixX::Identity(model->num_velocities(), model->num_velocities()) - inverse * park.J;
    VectorX gradient = VectorX::Zero(model->num_velocities());
    gradient.tail(model->num_joints()) = 0.02 * park.J_m / 0.01;
    VectorX expected = rrmc.command + projector * gradient;
    const VectorX limit = model->velocity_limits();
    if ((expected.array().abs() < limit.array()).all()) {
      EXPECT_LT((park.command - expected).lpNorm<Eigen::Infinity>(), 1e-7) << model->name;
    }
    const Answer baur = run(model, slow(Method::kBaur), o);
    for (int i = 0; i < model->num_joints(); ++i) {
      const ControlledJoint& j = model->joints[static_cast<std::size_t>(i)];
      const auto push = [](double room) { return room < 0.9 ? std::pow((room - 0.9) / 0.85, 2) : 0.0; };
      gradient[base + i] += push(o.q[i] - j.lower) - push(j.upper - o.q[i]);
    }
    expected = rrmc.command + projector * gradient;
    if ((expected.array().abs() < limit.array()).all()) {
      EXPECT_LT((baur.command - expected).lpNorm<Eigen::Infinity>(), 1e-7) << model->name;
    }
  }
}

TEST(ClosedForm, ScaledAsAWholeIntoTheLimits) {
  Rng rng(43);
  const auto model = frankie();
  for (const Method method : {Method::kRrmc, Method::kPark, Method::kBaur}) {
    for (int trial = 0; trial < 100; ++trial) {
      const Observation o = random_observation(*model, 0, rng);
      ControllerParams p = slow(method);
      const Answer gentle = run(model, p, o);
      p.servo = {200, 200, kInfinity, kInfinity};
      const Answer hard = run(model, p, o);
      const VectorX limit = model->velocity_limits();
      EXPECT_LE((hard.command.array().abs() - limit.array()).maxCoeff(), 0.0);
      Eigen::Vector4d wheels;
      const int count = wheel_speeds(model->base, hard.command, wheels);
      ASSERT_EQ(count, 2);
      for (int i = 0; i < 2; ++i) EXPECT_LE(std::abs(wheels[i]), model->base.wheels->max_speed + 1e-12);
      if (method != Method::kRrmc) continue;
      // Same direction as the unscaled J^+ nu.
      const VectorX full = damped_inverse(hard.J) * hard.nu;
      EXPECT_NEAR(hard.command.normalized().dot(full.normalized()), 1.0, 1e-9);
    }
  }
}

// Without damping and scaling: the published baselines. All of J counts then, also at a singularity.
TEST(ClosedForm, UndampedItIsThePseudoinverse) {
  Rng rng(43);
  int beyond = 0, other = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const auto model = built_robots()[rng() % 3];
    Observation o = random_observation(*model, 0, rng);
    o.goal.V_WG_W.setZero();
    if (model->name == "panda" && trial % 2 == 0) o.q.head(3).setZero(), o.q[4] = 0, o.q[5] = uniform(rng, 0, 0.02);
    ControllerParams p;
    p.method = Method::kRrmc;
    p.servo = {3, 3, kInfinity, kInfinity};
    const Answer usual = run(model, p, o);
    p.closed_form = {0.0, false};
    const Answer r = run(model, p, o);
    const MatrixX J = r.J;
    const Eigen::CompleteOrthogonalDecomposition<MatrixX> decomposition(J);
    const VectorX expected = decomposition.solve(r.nu);
    EXPECT_LT((r.command - expected).norm(), 1e-6 * (1.0 + expected.norm())) << model->name << " " << trial;
    beyond += (r.command.cwiseAbs() - model->velocity_limits()).maxCoeff() > 0.0 ? 1 : 0;
    other += (r.command - usual.command).norm() > 1e-6 ? 1 : 0;
  }
  EXPECT_GT(beyond, 50) << "no command was beyond a limit: scaling cannot be seen";
  EXPECT_GT(other, 50);
}

}  // namespace
}  // namespace moma
