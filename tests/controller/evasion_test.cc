// Ways out of the way of what moves: what passes against a simulation in fine steps, what is chosen where nothing
// passes, and robots that would be run over.

#include "controller/safe/evasion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "controller/safe/base_ramp.h"
#include "tests/controller/rig.h"
#include "tests/support/control_period.h"
#include "tests/support/no_alloc.h"

namespace moma {
namespace {

using namespace test;

constexpr EvasionParams kParams{.enabled = true, .horizon = 2.0, .margin = 0.08};

class EvasionScene {
 public:
  EvasionScene(std::shared_ptr<const RobotModel> model, std::vector<ObjectShape> shapes)
      : model_(std::move(model)), kinematics_(model_), proximity_(model_) {
    proximity_.set_objects(shapes);
  }
  // The robot's distance to each object.
  std::vector<double> of(const Observation& o) {
    kinematics_.update(o.base, o.q);
    std::vector<double> out(o.objects.size(), kInfinity);
    for (const ProximityPair& pair : proximity_.query(kinematics_, o.objects, {5.0, -1.0, -1.0})) {
      double& d = out[static_cast<std::size_t>(pair.second)];
      d = std::min(d, pair.distance.d);
    }
    return out;
  }
  double least(const Observation& o) { return std::ranges::min(of(o)); }

 private:
  std::shared_ptr<const RobotModel> model_;
  Kinematics kinematics_;
  Proximity proximity_;
};

void advance(const RobotModel& model, Observation& o, const VectorX& velocity, double dt) {
  integrate(model, o.base, o.q, velocity, dt);
  for (ObjectState& object : o.objects) object.X_WO.translation() += dt * object.V_WO_W.tail<3>();
}

// One period of the command, then the base walks to the target and the joints to rest, in steps of a millisecond.
// Whether distances stay above what is needed less `slack` (which may be negative) all along.
bool clear_in_fine_steps(const RobotModel& model, EvasionScene& scene, Observation o, const VectorX& command,
                         const Vector3& target, double arm, double slack) {
  constexpr double kStep = 1e-3;
  const std::vector<double> now = scene.of(o);
  const int dof = model.base_dof();
  VectorX v = o.qdot;
  v.tail(model.num_joints()) = command.tail(model.num_joints());
  for (int k = 0; k < 2000; ++k) {
    const bool first = k < 20;
    double linear = 0.0;
    for (int i = 0; i + 1 < dof; ++i) linear += std::pow((first ? command[i] : target[i]) - v[i], 2);
    linear = std::sqrt(linear);
    const double part = linear > 0.0 ? std::min(1.0, model.base.max_acceleration.x() * kStep / linear) : 0.0;
    for (int i = 0; i + 1 < dof; ++i) v[i] += part * ((first ? command[i] : target[i]) - v[i]);
    const double turn = (first ? command[dof - 1] : target[dof - 1]) - v[dof - 1];
    const double most = model.base.max_acceleration.y() * kStep;
    v[dof - 1] += std::fabs(turn) > most ? std::copysign(most, turn) : turn;
    if (!first)
      for (int i = dof; i < v.size(); ++i) v[i] -= std::copysign(std::min(std::fabs(v[i]), arm * kStep), v[i]);
    advance(model, o, v, kStep);
    if (k % 10 != 9 || first) continue;
    const std::vector<double> gaps = scene.of(o);
    const double margin = kParams.margin + kParams.reaction * v.head(dof - 1).norm();
    for (std::size_t i = 0; i < gaps.size(); ++i)
      if (gaps[i] < std::min(in_motion(o.objects[i]) ? margin : kParams.at_rest, now[i]) - slack) return false;
  }
  return true;
}

struct Drawn {
  std::vector<ObjectShape> shapes;
  Observation o;
  VectorX command;
};

// Things that come towards a robot that drives, and things that stand about.
Drawn draw(const RobotModel& model, Rng& rng) {
  Drawn out;
  const int nv = model.num_velocities();
  out.o.base = Vector3(0, 0, uniform(rng, -kPi, kPi));
  out.o.q = model.ready;
  out.o.qdot = VectorX::Zero(nv);
  out.o.goal.X_WG.translation() = Vector3(3, 0, 0.7);
  for (int i = 0; i < model.base_dof(); ++i) out.o.qdot[i] = uniform(rng, -0.6, 0.6);
  out.command = out.o.qdot;
  for (int i = 0; i < nv; ++i) out.command[i] += uniform(rng, -0.03, 0.03);
  for (int k = 0; k < 5; ++k) {
    out.shapes.push_back({"ball" + std::to_string(k), {ShapeKind::kSphere, {uniform(rng, 0.1, 0.3), 0, 0}, nullptr}});
    ObjectState ball;
    const double from = uniform(rng, -kPi, kPi), far = uniform(rng, 0.9, 1.8), off = uniform(rng, -0.4, 0.4);
    ball.X_WO.translation() = Vector3(far * std::cos(from), far * std::sin(from), 0.35);
    if (k < 4) {
      const double speed = uniform(rng, 0.3, 1.2);
      ball.V_WO_W.tail<3>() = Vector3(-speed * std::cos(from + off), -speed * std::sin(from + off), 0.0);
    }
    out.o.objects.push_back(ball);
  }
  return out;
}

TEST(Evasion, WhatPassesHasAWayOutAndWhatDoesNotHasNone) {
  Rng rng(61);
  int passed = 0, refused = 0;
  for (const auto& model : {frankie(), mecanum()}) {
    const VectorX acceleration = VectorX::Constant(model->num_velocities(), 5.0);
    for (int trial = 0; trial < 120; ++trial) {
      Drawn d = draw(*model, rng);
      Evasion evasion(model, kParams, acceleration, 0.95, model->base.max_linear, kPeriod);
      evasion.set_objects(d.shapes);
      EvasionScene scene(model, d.shapes);
      if (scene.least(d.o) < 0.02) continue;
      VectorX base = VectorX::Zero(model->num_velocities());
      const bool passes = evasion.passes(d.o, d.command, base);
      std::vector<Vector3> targets{Vector3::Zero(), Vector3::Zero()};
      for (int i = 0; i < model->base_dof(); ++i) targets[1][i] = d.command[i];
      for (const Vector3& v : evasion.velocities()) targets.push_back(v);
      bool any = false;
      for (const Vector3& target : targets)
        any = any || clear_in_fine_steps(*model, scene, d.o, d.command, target, 5.0, passes ? 0.02 : -0.02);
      EXPECT_EQ(any, passes) << model->name << " trial " << trial;
      (passes ? passed : refused) += 1;
      if (!passes) {
        EXPECT_EQ(evasion.tried(), 3 + 2 * static_cast<int>(evasion.velocities().size()));
        // What is to be done begins within the drive's means.
        Vector3 change = Vector3::Zero();
        for (int i = 0; i < model->base_dof(); ++i) change[i] = base[i] - d.o.qdot[i];
        EXPECT_LE(change.head(model->base_dof() - 1).norm(), 0.95 * kPeriod * model->base.max_acceleration.x() + 1e-12);
        EXPECT_LE(std::abs(change[model->base_dof() - 1]), 0.95 * kPeriod * model->base.max_acceleration.y() + 1e-12);
      }
    }
  }
  EXPECT_GT(passed, 100);
  EXPECT_GT(refused, 10);
}

// A ball in front of Frankie and one behind it, both in motion.
struct Between {
  std::shared_ptr<const RobotModel> model = frankie();
  std::vector<ObjectShape> balls{{"before", {ShapeKind::kSphere, {0.2, 0, 0}, nullptr}},
                                 {"behind", {ShapeKind::kSphere, {0.2, 0, 0}, nullptr}}};
  EvasionScene scene{model, balls};
  Observation o;

  Between(double before, double behind) {
    o.q = model->ready;
    o.qdot = VectorX::Zero(model->num_velocities());
    o.objects.resize(2);
    for (const int side : {1, -1}) o.objects[side > 0 ? 0 : 1].X_WO.translation() = Vector3(side * 3.0, 0, 0.25);
    for (int k = 0; k < 50; ++k) {  // distances shrink by no more than the balls move
      const std::vector<double> gaps = scene.of(o);
      o.objects[0].X_WO.translation().x() -= gaps[0] - before;
      o.objects[1].X_WO.translation().x() += gaps[1] - behind;
    }
  }
  bool passes(double forward, const EvasionParams& params = kParams) {
    VectorX command = o.qdot, base = o.qdot;
    command[0] = forward;
    Evasion evasion(model, params, VectorX::Constant(model->num_velocities(), 5.0), 1.0, model->base.max_linear,
                    kPeriod);
    evasion.set_objects(balls);
    return evasion.passes(o, command, base);
  }
};

// A near object on one side takes nothing from the distance kept from another: the ball before the robot comes to 5 cm
// within the horizon if the robot stands, which is less than the margin.
TEST(Evasion, EachObjectHasADistanceOfItsOwn) {
  for (const double behind : {2.5, 0.03}) {
    Between scene(0.11, behind);
    scene.o.objects[0].V_WO_W[3] = -0.03;
    scene.o.objects[1].V_WO_W[4] = 0.02;
    EXPECT_EQ(scene.passes(0.0), behind > 1.0) << behind << " m behind it";
  }
}

// Within the margin the robot comes nearer only as fast as it stops until the first check.
TEST(Evasion, ComesNearerOnlyAsFastAsItStops) {
  for (const double speed : {0.0, 0.03, 0.06, 0.09, 0.15, 0.3})
    for (const double first : {0.02, 0.1}) {
      Between scene(0.07, 2.0);
      scene.o.objects[0].V_WO_W[4] = 0.02;
      scene.o.qdot[0] = speed;
      EvasionParams params = kParams;
      params.first = first;
      // Distance covered in one period and in the time of the first check, while the base brakes and backs off.
      const double a = scene.model->base.max_acceleration.x();
      const double covered = speed * (kPeriod + first) - 0.5 * a * first * first;
      EXPECT_EQ(scene.passes(speed, params), covered <= 0.0) << speed << " m/s, " << first << " s";
    }
  Between far(0.5, 2.0);
  far.o.objects[0].V_WO_W[4] = 0.02;
  far.o.qdot[0] = 0.3;
  EXPECT_TRUE(far.passes(0.3));
}

TEST(Evasion, WaysOutAreNoFasterThanCommandsMayBe) {
  for (const auto& model : {frankie(), mecanum()}) {
    const VectorX acceleration = VectorX::Constant(model->num_velocities(), 5.0);
    for (const double most : {0.3, model->base.max_linear}) {
      const Evasion evasion(model, kParams, acceleration, 0.95, most, kPeriod);
      double fastest = 0.0;
      for (const Vector3& v : evasion.velocities()) fastest = std::max(fastest, v.head(model->base_dof() - 1).norm());
      EXPECT_LE(fastest, most + 1e-12) << model->name;
      EXPECT_GT(fastest, 0.5 * most) << model->name << ": wheels may allow less";
    }
  }
}

TEST(Evasion, LeavesWorldsAloneInWhichNothingMoves) {
  Rng rng(62);
  const auto model = frankie();
  ControllerParams params;
  ControllerParams evading = params;
  evading.collision.evasion = kParams;
  const std::vector<ObjectShape> shapes = random_objects(rng, 6);
  Rig plain(model, params, shapes), other(model, evading, shapes);
  for (int k = 0; k < 200; ++k) {
    Observation o = random_observation(*model, shapes.size(), rng, 1.2);
    for (ObjectState& object : o.objects) object.V_WO_W.setZero();
    plain.step(o);
    other.step(o);
    ASSERT_EQ(plain.result.command, other.result.command) << k;
    EXPECT_FALSE(other.controller.evades());
  }
}

ControllerParams driving(const RobotModel& model) {
  ControllerParams p;
  p.servo.max_linear = p.servo.max_angular = 0.8;
  p.base_weight = {false, 0.01};
  p.slack.weight = {false, 9.0};
  p.joint_limits.method = JointLimitMethod::kDamper;
  p.collision.object = {true, 0.3, 0.03, 0.6};
  p.acceleration_limit = VectorX::Constant(model.num_velocities(), 5.0);
  p.base_share = 0.95;
  p.collision.braking.enabled = true;
  p.collision.relaxation = Relaxation::kBackup;
  return p;
}

// A ball comes at the side of a robot that has somewhere to go: how often it is hit within 6 s.
TEST(Evasion, ARobotIsNotRunOver) {
  const auto model = frankie();
  const std::vector<ObjectShape> ball{{"ball", {ShapeKind::kSphere, {0.25, 0, 0}, nullptr}}};
  EvasionScene scene(model, ball);
  std::array<int, 2> hit{};
  int evaded = 0;
  for (const bool evading : {false, true}) {
    Rng rng(63);
    for (int trial = 0; trial < 40; ++trial) {
      ControllerParams params = driving(*model);
      params.collision.evasion = kParams;
      params.collision.evasion.enabled = evading;
      Rig rig(model, params, ball);
      Observation o;
      o.q = model->ready;
      o.qdot = VectorX::Zero(model->num_velocities());
      o.goal.X_WG = pose(uniform(rng, 1.0, 3.0), uniform(rng, -0.5, 0.5), 0.6, kPi, 0, 0);
      o.objects.resize(1);
      // It and the robot would meet after some two seconds.
      const double from = uniform(rng, -2.5, 2.5), speed = uniform(rng, 0.3, 0.6), after = uniform(rng, 1.5, 4.0);
      const Vector3 way(std::cos(from), std::sin(from), 0.0);
      o.objects[0].X_WO.translation() = Vector3(0.3 * after, 0, 0.4) + speed * after * way;
      o.objects[0].V_WO_W.tail<3>() = -speed * way;
      if (scene.least(o) < 0.3) continue;
      bool touched = false;
      for (int k = 0; k < 300 && !touched; ++k) {
        rig.step(o);
        evaded += rig.controller.evades() ? 1 : 0;
        // The terms tell the task that was solved in the end, not the one that the guard refused.
        const double cost = rig.controller.cost();
        if (rig.result.fallback != Fallback::kBrake) {
          EXPECT_NEAR(rig.sum_of_terms(), cost, 1e-9 * std::max(1.0, std::abs(cost)));
        }
        advance(*model, o, rig.result.command, kPeriod);
        o.qdot = rig.result.command;
        touched = scene.least(o) < 0.0;
      }
      hit[evading ? 1 : 0] += touched ? 1 : 0;
    }
  }
  EXPECT_GT(hit[0], 5) << "the scenes are harmless";
  EXPECT_EQ(hit[1], 0);
  EXPECT_GT(evaded, 50);
}

TEST(Evasion, TakesNoMemoryAndNothingIsRemembered) {
  Rng rng(64);
  for (const auto& model : {frankie(), mecanum()}) {
    ControllerParams params = driving(*model);
    params.collision.evasion = kParams;
    std::vector<Drawn> seen;
    for (int k = 0; k < 40; ++k) seen.push_back(draw(*model, rng));
    const std::vector<ObjectShape> shapes = seen[0].shapes;
    Rig rig(model, params, shapes);
    std::vector<VectorX> commands;
    std::vector<int> evades;
    commands.reserve(seen.size());
    for (const Drawn& d : seen) commands.push_back(d.command);
    evades.assign(seen.size(), 0);
    int taken = 0;
    {
      const NoAlloc guard;
      for (std::size_t k = 0; k < seen.size(); ++k) {
        rig.step(seen[k].o);
        commands[k] = rig.result.command;
        evades[k] = rig.controller.evades() ? 1 : 0;
      }
      taken = guard.count();
    }
    if (NoAlloc::works()) {
      EXPECT_EQ(taken, 0);
    }
    int some = 0;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      Rig fresh(model, params, shapes);
      fresh.step(seen[k].o);
      EXPECT_EQ(fresh.result.command, commands[k]) << k;
      some += evades[k];
    }
    EXPECT_GT(some, 0) << model->name;
  }
}

}  // namespace
}  // namespace moma
