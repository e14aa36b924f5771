// The controller with prediction, hard bounds of the base, braking rows, backup relaxation and the check ahead: its
// bounds under anything, what its relaxation gives away, its memory, and a robot that is late.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <deque>

#include "tests/controller/rig.h"
#include "tests/support/control_period.h"
#include "tests/support/no_alloc.h"

namespace moma {
namespace {

using namespace test;

ControllerParams safe_params(const RobotModel& model) {
  ControllerParams p;
  p.servo.max_linear = 0.8;
  p.servo.max_angular = 0.8;
  p.base_weight = {false, 0.01};
  p.slack.weight = {false, 9.0};
  p.joint_limits.method = JointLimitMethod::kDamper;
  p.collision.object = {true, 0.3, 0.03, 0.6};
  p.acceleration_limit = VectorX::Constant(model.num_velocities(), 5.0);
  p.base_share = 0.95;
  p.collision.braking.enabled = true;
  p.collision.relaxation = Relaxation::kBackup;
  p.collision.check.enabled = p.collision.evasion.enabled = true;
  PredictionParams& r = p.prediction;
  r.enabled = r.identify = true;
  r.base_drive = 0.06;
  r.joint_drive = 0.02;
  r.base_sensing = 0.02;
  r.object_sensing = r.goal_sensing = 0.08;
  r.base_filter = r.moving_filter = 0.1;
  r.resting_filter = 0.4;
  r.twist_filter = 0.15;
  return p;
}

Observation some_observation(const RobotModel& model, std::size_t objects, Rng& rng) {
  Observation o = random_observation(model, objects, rng, rng() % 4 == 0 ? 4.0 : 0.9);
  for (ObjectState& object : o.objects) {
    if (rng() % 2 == 0) object.V_WO_W.setZero();
    object.visible = rng() % 8 != 0;
  }
  switch (rng() % 40) {
    case 0:
      o.q[0] = NAN;
      break;
    case 1:
      o.objects.pop_back();
      break;
    case 2:
      o.qdot[0] = INFINITY;
      break;
    default:
      break;
  }
  return o;
}

// For each robot. MOMA_MANY_STEPS=333334 makes a million of it.
long random_steps() {
  const char* many = std::getenv("MOMA_MANY_STEPS");
  return many != nullptr ? std::atol(many) : 5000;
}

TEST(SafeController, NoCommandLeavesItsBoundsWhateverIsSeen) {
  for (const auto& model : built_robots()) {
    Rng rng(1);
    const int dof = model->base_dof();
    const VectorX speed = model->velocity_limits();
    const double linear = 0.95 * kPeriod * model->base.max_acceleration.x() + 1e-7;
    const double turn = 0.95 * kPeriod * model->base.max_acceleration.y() + 1e-7;
    Rig rig(model, safe_params(*model), random_objects(rng, 8));
    std::array<long, 4> stages{};
    VectorX before = VectorX::Zero(speed.size());
    for (long k = 0; k < random_steps(); ++k) {
      rig.step(some_observation(*model, 8, rng));
      const VectorX& u = rig.result.command;
      ++stages[static_cast<std::size_t>(rig.result.fallback)];
      ASSERT_TRUE(u.allFinite()) << model->name << " step " << k;
      for (Eigen::Index i = 0; i < u.size(); ++i)
        ASSERT_LE(std::abs(u[i]), speed[i] + 1e-7) << model->name << " step " << k << " velocity " << i;
      if (dof > 0) {
        ASSERT_LE((u - before).head(dof - 1).norm(), linear) << model->name << " step " << k;
        ASSERT_LE(std::abs(u[dof - 1] - before[dof - 1]), turn) << model->name << " step " << k;
        for (const double wheel : rig.controller.wheels()) ASSERT_LE(std::abs(wheel), 12.0 + 1e-5);
      }
      before = u;
    }
    for (const long count : stages) EXPECT_GT(count, 20) << model->name << ": a stage of the fallback was not met";
  }
}

TEST(SafeController, TakesNoMemory) {
  if (!NoAlloc::works()) GTEST_SKIP() << "a sanitizer owns malloc";
  for (const auto& model : built_robots()) {
    Rng rng(2);
    Rig rig(model, safe_params(*model), random_objects(rng, 12));
    std::vector<Observation> seen;
    for (int i = 0; i < 300; ++i) seen.push_back(some_observation(*model, 12, rng));
    ControllerMemory memory;
    rig.controller.get_memory(memory);
    NoAlloc guard;
    for (const Observation& o : seen) {
      rig.controller.step(o, rig.result);
      rig.controller.get_memory(memory);
      rig.controller.set_memory(memory);
      ASSERT_EQ(guard.count(), 0) << model->name << " " << to_string(rig.result.fallback);
    }
  }
}

TEST(SafeController, AStepIsAFunctionOfItsMemoryAndWhatIsSeen) {
  for (const auto& model : built_robots()) {
    Rng rng(3);
    const std::vector<ObjectShape> shapes = random_objects(rng, 6);
    ControllerParams params = safe_params(*model);
    params.escape.enabled = true;
    params.escape.patience = 0.1;
    Rig first(model, params, shapes), second(model, params, shapes);
    // The other has a past of its own.
    for (int k = 0; k < 20; ++k) second.step(some_observation(*model, 6, rng));
    ControllerMemory memory;
    Observation o = random_observation(*model, 6, rng, 1.0);
    for (int k = 0; k < 200; ++k) {
      if (k % 9 == 0) o = some_observation(*model, 6, rng);
      o.goal.X_WG.translation().x() += k % 31 == 0 ? 0.3 : 0.0;
      first.controller.get_memory(memory);
      second.controller.set_memory(memory);
      first.step(o);
      second.step(o);
      ASSERT_EQ(first.result.command, second.result.command) << model->name << " step " << k;
      ASSERT_EQ(first.result.kept, second.result.kept);
      ASSERT_EQ(first.result.iterations, second.result.iterations);
    }
  }
}

// What the relaxed stage gives to rows: no more than full braking takes, and to rows that braking keeps, nothing.
TEST(SafeController, RelaxesRowsOfWhatRestsAsFarAsBrakingBreaksThem) {
  Rng rng(4);
  int relaxed = 0, kept_rows = 0, broken_rows = 0;
  for (const auto& model : built_robots()) {
    ControllerParams params = safe_params(*model);
    params.prediction = {};
    params.collision.check.enabled = params.collision.evasion.enabled = false;
    Rig rig(model, params, random_objects(rng, 8));
    const int nv = model->num_velocities();
    for (int trial = 0; trial < 3000; ++trial) {
      Observation o = random_observation(*model, 8, rng, 0.8);
      for (ObjectState& object : o.objects)
        if (rng() % 4 != 0) object.V_WO_W.setZero();
      rig.step(o);
      const auto& outcome = rig.controller.outcome();
      if (outcome.fallback != Fallback::kRelaxed || outcome.only_separation) continue;
      ++relaxed;
      EXPECT_LT(rig.controller.kkt_residual(), 1e-3) << model->name << " trial " << trial;
      const QpProblem& asked = rig.controller.problem();
      const QpProblem solved = rig.controller.final_problem();
      const VectorX x = rig.controller.solution().x;
      VectorX braked(nv);
      for (int i = 0; i < nv; ++i) braked[i] = std::min(std::max(0.0, solved.lb[i]), solved.ub[i]);
      if (model->base_dof() == 3) {  // the pair brakes along its own direction
        const VectorX most = model->velocity_limits();
        const Vector2 v = o.qdot.head<2>().cwiseMax(-most.head<2>()).cwiseMin(most.head<2>());
        const double step = params.base_share * kOctagon * kPeriod * model->base.max_acceleration.x();
        braked.head<2>() = std::max(0.0, 1.0 - step / v.norm()) * v;
      }
      double most = 0.0;
      std::vector<double> broken(static_cast<std::size_t>(asked.rows), -1.0);
      for (int r = 0; r < asked.rows; ++r) {
        const RowId& id = asked.ids[static_cast<std::size_t>(r)];
        if (!is_collision(id.kind) || id.moves) continue;
        const double over = std::max(0.0, asked.A.row(r).head(nv).dot(braked) - asked.ubA[r]);
        broken[static_cast<std::size_t>(r)] = over;
        most = std::max(most, over);
      }
      const double s = x[asked.n()];
      // Only before what moves may more be given away: there is no other limit to it than its cost.
      bool traffic = false;
      for (int r = 0; r < asked.rows; ++r) {
        const RowId& id = asked.ids[static_cast<std::size_t>(r)];
        traffic = traffic || id.moves;
      }
      if (!traffic) {
        EXPECT_LE(s, most + 1e-3);
      }
      for (int r = 0; r < asked.rows; ++r) {
        const double g = broken[static_cast<std::size_t>(r)];
        if (g < 0.0) continue;
        const double over = asked.A.row(r).head(nv).dot(x.head(nv)) - asked.ubA[r];
        EXPECT_LE(over, (most > 0.0 ? s * g / most : 0.0) + 1e-5) << rig.controller.row_name(r);
        (g > 0.0 ? broken_rows : kept_rows) += 1;
      }
    }
  }
  EXPECT_GT(relaxed, 100);
  EXPECT_GT(kept_rows, 100);
  EXPECT_GT(broken_rows, 100);
}

// In each direction the octagon has at least 0.92 of the circle that the drives bound, and nothing outside of it.
TEST(SafeController, DrivesOfAPairAreBoundAsOneVector) {
  const auto model = mecanum();
  ControllerParams params = safe_params(*model);
  params.prediction = {};
  Rig rig(model, params);
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(model->num_velocities());
  const double most = 0.95 * kPeriod * model->base.max_acceleration.x();
  for (int k = 0; k < 64; ++k) {
    const double angle = 2.0 * kPi * k / 64;
    o.goal.X_WG.translation() = Vector3(5.0 * std::cos(angle), 5.0 * std::sin(angle), 0.8);
    rig.step(o);
    const double change = rig.result.command.head<2>().norm();
    EXPECT_LE(change, most + 1e-9) << k;
    EXPECT_GE(change, 0.9 * most) << k;
    EXPECT_EQ(rig.rows(RowKind::kDrive), 2);
  }
}

TEST(SafeController, RemembersTheCommandsOfStepsWithoutMeasurements) {
  const auto model = frankie();
  ControllerParams params = safe_params(*model);
  params.prediction.identify = false;  // this robot is measured to stand still
  params.lambda_q = VectorX::Constant(7, 10.0);
  Rig rig(model, params);
  Observation o;
  o.q = model->ready;
  o.qdot = VectorX::Zero(9);
  o.goal.X_WG.translation() = Vector3(4, 0, 0.8);
  for (int k = 0; k < 30; ++k) rig.step(o);
  const VectorX before = rig.result.command;
  ASSERT_GT(before[0], 0.1);
  ControllerMemory memory;
  o.q[0] = NAN;
  for (int k = 0; k < 100; ++k) {
    rig.step(o);
    EXPECT_EQ(rig.result.fallback, Fallback::kBrake);
    rig.controller.get_memory(memory);
    EXPECT_EQ(memory.prediction.sent.front(), rig.result.command);
    if (k == 0) {
      EXPECT_NEAR(before[0] - rig.result.command[0], 0.95 * 0.02 * model->base.max_acceleration.x(), 1e-9);
    }
  }
  EXPECT_TRUE(rig.result.command.isZero(1e-12));
}

}  // namespace
}  // namespace moma
