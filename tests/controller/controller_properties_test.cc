// Properties of a step over robots, states, gains and objects drawn by RapidCheck. A failure prints the case, made as
// small as it goes, and the RC_PARAMS that repeat it; RC_PARAMS="max_success=20000" looks further than ctest does.

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cstdlib>
#include <sstream>

#include "controller/controller_core.h"
#include "tests/controller/qp_robots.h"
#include "tests/support/control_period.h"
#include "tests/support/solvers.h"

namespace moma {
namespace {

using namespace test;

const bool kSeeded = ::setenv("RC_PARAMS", "seed=20260701 max_success=1000", 0) == 0;

double real(double low, double high) {
  constexpr int kParts = 1 << 20;
  return low + (high - low) * *rc::gen::inRange(0, kParts + 1) / kParts;
}
template <typename T>
T one_of(std::initializer_list<T> options) {
  return *rc::gen::elementOf(std::vector<T>(options));
}
bool coin() { return *rc::gen::arbitrary<bool>(); }
Weight weight(double low, double high) { return coin() ? Weight{} : Weight{false, real(low, high)}; }

// All robots and states that a shrunk seed can still give; the seed itself says nothing, so it is not made smaller.
std::uint64_t seed() { return *rc::gen::noShrink(rc::gen::arbitrary<std::uint64_t>()); }

/// One of three known robots, or any.
std::shared_ptr<const RobotModel> some_robot() {
  const auto which = static_cast<std::size_t>(*rc::gen::inRange(0, 6));
  if (which < 3) return built_robots()[which];
  Rng rng(seed());
  return random_robot(rng);
}

ControllerParams gains(const RobotModel& model) {
  ControllerParams p;
  p.servo = {.position = real(0, 5),
             .orientation = real(0, 5),
             .max_linear = one_of({0.5, 1.0, kInfinity}),
             .max_angular = one_of({0.7, 1.5, kInfinity})};
  p.error_norm.kind = one_of({ErrorNormKind::kEuclidean, ErrorNormKind::kL1, ErrorNormKind::kPose});
  p.base_weight = weight(0.01, 2.0);
  p.lambda_q = VectorX::Constant(model.num_joints(), real(0.003, 0.3));
  p.slack.weight = weight(0.5, 1000.0);
  if (coin()) p.slack.limit.setConstant(one_of({2.0, 30.0, kInfinity}));
  if (coin()) p.tracking_band.setConstant(real(0, 0.05));
  p.k_epsilon = real(0, 3);
  p.manipulability.weight = real(0, 2);
  p.manipulability.rows =
      one_of({ManipulabilityRows::kTranslation, ManipulabilityRows::kRotation, ManipulabilityRows::kAll});
  p.joint_limits.method = one_of({JointLimitMethod::kSource, JointLimitMethod::kDamper, JointLimitMethod::kNone});
  p.collision.object.gain = real(0.1, 2.0);
  p.collision.max_pairs = one_of({0, 4, 30});
  if (coin()) p.acceleration_weight = VectorX::Constant(model.num_velocities(), real(0, 1));
  if (coin()) p.posture.weight = real(0, 1);
  if (coin()) p.acceleration_limit = VectorX::Constant(model.num_velocities(), real(1, 20));
  p.output_scaling.enabled = one_of({false, false, false, true});
  return p;
}

struct Drawn {
  std::shared_ptr<const RobotModel> model;
  ControllerParams params;
  std::vector<ObjectShape> shapes;
  Observation seen;
};

Drawn draw() {
  Drawn d;
  d.model = some_robot();
  d.params = gains(*d.model);
  Rng rng(seed());
  d.shapes = random_objects(rng, *rc::gen::inRange<std::size_t>(0, 13));
  d.seen = random_observation(*d.model, d.shapes.size(), rng);
  // Some joints at their limits, or a little beyond them.
  for (int i = 0; i < d.model->num_joints(); ++i) {
    const ControlledJoint& joint = d.model->joints[static_cast<std::size_t>(i)];
    if (rng() % 8 == 0 && std::isfinite(joint.upper)) d.seen.q[i] = joint.upper + (rng() % 2 ? 0.0 : 0.02);
    if (rng() % 8 == 0 && std::isfinite(joint.lower)) d.seen.q[i] = joint.lower - (rng() % 2 ? 0.0 : 0.02);
  }
  return d;
}

struct Stepped {
  std::unique_ptr<ControllerCore> controller;
  StepResult result;
};

Stepped step(const Drawn& d, SolverMaker make = &make_solver) {
  Stepped s{std::make_unique<ControllerCore>(d.model, d.params, kPeriod, make), {}};
  s.controller->reset(d.shapes);
  s.controller->prepare(s.result);
  s.controller->step(d.seen, s.result);
  return s;
}

std::string describe(const Drawn& d, const Stepped& s) {
  std::ostringstream text;
  text << d.model->name << ": " << to_string(s.result.status) << ", fallback " << to_string(s.result.fallback) << ", "
       << s.result.iterations << " iterations, " << s.result.rows << " rows, cost " << s.controller->cost()
       << ", residual " << s.controller->kkt_residual();
  return text.str();
}

bool no_other_solves(const Drawn& d) {
  for (const NamedSolver& solver : solvers())
    if (step(d, solver.make).result.status == StepStatus::kSolved) return false;
  return true;
}

TEST(ControllerProperties, SolvedStepsAreOptimalAndEveryCommandIsWithinItsBounds) {
  ASSERT_TRUE(kSeeded);
  EXPECT_TRUE(rc::check([] {
    const Drawn d = draw();
    const Stepped s = step(d);
    const ControllerCore& c = *s.controller;
    RC_CLASSIFY(s.result.status == StepStatus::kSolved, "solved");
    RC_LOG() << describe(d, s) << std::endl;
    RC_CLASSIFY(s.result.fallback == Fallback::kRelaxed, "relaxed");
    RC_ASSERT(s.result.status != StepStatus::kInvalidInput);
    // DAQP may go round in circles where rows contradict each other by little: never where there is a solution.
    if (s.result.status == StepStatus::kMaxIterations) RC_ASSERT(no_other_solves(d));
    if (s.result.fallback == Fallback::kNone || s.result.fallback == Fallback::kNoAcceleration)
      RC_ASSERT(c.kkt_residual() < 1e-7);

    RC_ASSERT(s.result.command.allFinite());
    const VectorX limit = d.model->velocity_limits();
    for (int i = 0; i < limit.size(); ++i) {
      RC_ASSERT(std::abs(s.result.command[i]) <= limit[i]);
      if (s.result.fallback != Fallback::kNone && s.result.fallback != Fallback::kBrake) continue;
      RC_ASSERT(s.result.command[i] >= c.problem().lb[i]);
      RC_ASSERT(s.result.command[i] <= c.problem().ub[i]);
    }
    // Beyond a limit, only the way back.
    for (int i = 0; d.params.joint_limits.method != JointLimitMethod::kNone && i < d.model->num_joints(); ++i) {
      const ControlledJoint& joint = d.model->joints[static_cast<std::size_t>(i)];
      const double v = s.result.command[d.model->base_dof() + i];
      if (d.seen.q[i] >= joint.upper) RC_ASSERT(v <= 0.0);
      if (d.seen.q[i] <= joint.lower) RC_ASSERT(v >= 0.0);
    }
    if (d.params.output_scaling.enabled || s.result.fallback == Fallback::kBrake) return;
    const VectorX wheels = c.wheels();
    for (const double w : wheels) RC_ASSERT(std::abs(w) <= d.model->base.wheels->max_speed + 1e-6);
  }));
}

TEST(ControllerProperties, AllSolversFindTheSameCost) {
  ASSERT_TRUE(kSeeded);
  const std::vector<NamedSolver> all = solvers();
  if (all.size() < 2) GTEST_SKIP() << "only DAQP is installed";
  EXPECT_TRUE(rc::check([&] {
    const Drawn d = draw();
    const Stepped first = step(d, all[0].make);
    for (std::size_t k = 1; k < all.size(); ++k) {
      const Stepped other = step(d, all[k].make);
      RC_LOG() << all[0].name << ": " << describe(d, first) << "\n"
               << all[k].name << ": " << describe(d, other) << std::endl;
      const bool solved = first.result.status == StepStatus::kSolved;
      RC_ASSERT(solved == (other.result.status == StepStatus::kSolved));
      RC_ASSERT(other.result.fallback == first.result.fallback);
      if (first.result.fallback == Fallback::kBrake) continue;
      const double cost = first.controller->cost();
      RC_ASSERT(std::abs(other.controller->cost() - cost) <= 1e-6 * std::max(1.0, std::abs(cost)));
    }
  }));
}

// A ball on its way in: placed so that its least distance to the robot is d_i -+ 1e-9, once without and once with its
// row. As the row enters it says that nothing may approach faster than xi.
struct Entry {
  double approach = 0.0;  // of the command without the row [m/s]
  double jump = 0.0;      // the largest change of a velocity, relative to its limit
  bool solved = false;
  bool one_row = false;
};

Entry enter(const std::shared_ptr<const RobotModel>& model, const ControllerParams& params, Rng& rng, double speed) {
  const std::vector<ObjectShape> ball = {{"ball", {ShapeKind::kSphere, {uniform(rng, 0.05, 0.2), 0, 0}, nullptr}}};
  Observation seen = random_observation(*model, 1, rng);
  Vector3 direction = random_vector(rng, 1.0);
  if (direction.norm() < 0.1) direction = Vector3::UnitX();
  direction.normalize();
  seen.objects[0].V_WO_W << 0, 0, 0, -speed * direction;

  Kinematics kinematics(model);
  kinematics.update(seen.base, seen.q);
  const Vector3 centre = kinematics.X_WE().translation();
  Proximity proximity(model);
  proximity.set_objects(ball);
  std::vector<ObjectState> state = seen.objects;
  ProximityPair nearest;
  const auto distance = [&](double along) {
    state[0].X_WO.translation() = centre + along * direction;
    nearest.distance.d = kInfinity;
    for (const ProximityPair& pair : proximity.query(kinematics, state, {20.0, -1.0, -1.0}))
      if (pair.distance.d < nearest.distance.d) nearest = pair;
    return nearest.distance.d;
  };
  // From the tip outwards the last place at d_i: bisection between the outside and the inside of it.
  double low = 0.0, high = 8.0;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (distance(middle) > params.collision.object.influence ? high : low) = middle;
  }
  const auto command = [&](double along, StepResult& result, int& rows) {
    seen.objects[0].X_WO.translation() = centre + along * direction;
    ControllerCore controller(model, params, kPeriod);
    controller.reset(ball);
    controller.prepare(result);
    controller.step(seen, result);
    rows = static_cast<int>(controller.distances().size());
    return result.status == StepStatus::kSolved;
  };
  Entry entry;
  StepResult outside, inside;
  int rows_outside = 0, rows_inside = 0;
  entry.solved = command(high + 1e-9, outside, rows_outside) && command(low - 1e-9, inside, rows_inside);
  entry.one_row = rows_outside == 0 && rows_inside == 1;
  distance(high);
  Matrix3X J_p(3, model->num_velocities());
  kinematics.point_jacobian(model->shapes[static_cast<std::size_t>(nearest.first)].link, nearest.distance.p_first_W,
                            J_p);
  const Vector3 relative = J_p * outside.command - seen.objects[0].V_WO_W.tail<3>();
  entry.approach = -nearest.distance.n_W.dot(relative);
  entry.jump = ((inside.command - outside.command).array() / model->velocity_limits().array()).abs().maxCoeff();
  return entry;
}

ControllerParams entering(double gain) {
  ControllerParams p;
  p.collision.floor.enabled = false;
  p.collision.self.enabled = false;
  p.collision.object.gain = gain;
  p.servo.max_linear = 0.8;
  p.servo.max_angular = 1.5;
  return p;
}

TEST(ControllerProperties, TheCommandIsContinuousWhereARowEntersNotTooFast) {
  ASSERT_TRUE(kSeeded);
  int compared = 0;
  EXPECT_TRUE(rc::check([&] {
    const auto model = some_robot();
    RC_PRE(!model->shapes.empty());
    const double gain = real(0.2, 2.0);
    Rng rng(seed());
    const Entry entry = enter(model, entering(gain), rng, real(-0.5, 0.5));
    RC_PRE(entry.solved && entry.one_row && entry.approach < gain - 1e-3);
    ++compared;
    RC_ASSERT(entry.jump < 1e-5);
  }));
  EXPECT_GE(compared, 1000);
}

TEST(ControllerProperties, AFasterObjectMakesTheCommandJumpAsItsRowEnters) {
  // The jump is what the robot needs to be as slow as xi at once; docs/explanation/controller.md gives these figures.
  Rng rng(71);
  double largest = 0.0, sum = 0.0;
  int jumps = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const double excess = uniform(rng, 0.05, 0.4);
    const Entry entry = enter(frankie(), entering(0.2), rng, 0.2 + excess);
    if (!entry.solved || !entry.one_row || entry.approach < 0.2 + 1e-3) continue;
    ++jumps;
    largest = std::max(largest, entry.jump);
    sum += entry.jump;
    EXPECT_GT(entry.jump, 1e-5) << "trial " << trial << ", approach " << entry.approach;
  }
  EXPECT_GT(jumps, 100);
  std::printf("an object faster than xi: %d entries, jump %.3f of the limits on average, at most %.3f\n", jumps,
              sum / jumps, largest);
}

TEST(ControllerProperties, ABallThatPassesChangesTheCommandGradually) {
  // Rows of several links come and go; four times finer samples change at most half as much from one to the next.
  const auto model = frankie();
  ControllerParams p = entering(1.0);
  const std::vector<ObjectShape> ball = {{"ball", {ShapeKind::kSphere, {0.1, 0, 0}, nullptr}}};
  const auto largest_change = [&](int samples, int& entered) {
    ControllerCore controller(model, p, kPeriod);
    controller.reset(ball);
    StepResult result;
    controller.prepare(result);
    Observation seen;
    seen.q = model->ready;
    seen.qdot = VectorX::Zero(9);
    seen.goal.X_WG = pose(1.5, 0.4, 0.8, kPi, 0, 0);
    seen.objects.resize(1);
    seen.objects[0].V_WO_W << 0, 0, 0, 0, -0.2, 0;
    double largest = 0.0;
    VectorX last;
    std::size_t rows = 0;
    entered = 0;
    for (int i = 0; i <= samples; ++i) {
      seen.objects[0].X_WO.translation() = Vector3(0.85, 1.2 - 2.4 * i / samples, 0.75);
      controller.step(seen, result);
      EXPECT_EQ(result.status, StepStatus::kSolved) << i;
      entered += controller.distances().size() != rows ? 1 : 0;
      rows = controller.distances().size();
      if (i > 0) largest = std::max(largest, (result.command - last).lpNorm<Eigen::Infinity>());
      last = result.command;
    }
    return largest;
  };
  int coarse_rows = 0, fine_rows = 0;
  const double coarse = largest_change(500, coarse_rows), fine = largest_change(2000, fine_rows);
  EXPECT_GE(coarse_rows, 4);
  EXPECT_LT(fine, 0.5 * coarse) << coarse;
}

}  // namespace
}  // namespace moma
