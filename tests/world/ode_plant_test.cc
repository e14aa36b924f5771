#include <gtest/gtest.h>
#include <ode/ode.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <thread>

#include "tests/world/support.h"
#include "world/draws.h"
#include "world/plant/ode_library.h"
#include "world/plant/rigid_bodies.h"

namespace moma {
namespace {

using test::empty_world;
using test::robot;
using test::solid;

const SimulationConfig kDynamicMode;

/// The command as the base's ramp lets it through, integrated exactly: what a base without slip does.
struct RampedBase {
  Vector3 base = Vector3::Zero();
  VectorX speed;
  bool ramps = false;  // in the last duration
  void advance(const RobotModel& model, const VectorX& command, double duration) {
    const int dof = model.base_dof();
    if (speed.size() == 0) speed = VectorX::Zero(dof);
    VectorX q = model.ready;
    constexpr int kParts = 1000;
    ramps = (command.head(dof) - speed).norm() > 0.0;
    for (int i = 0; i < kParts; ++i) {
      const double h = duration / kParts;
      VectorX change = command.head(dof - 1) - speed.head(dof - 1);
      const double most = model.base.max_acceleration.x() * h;
      if (change.norm() > most) change *= most / change.norm();
      speed.head(dof - 1) += change;
      const double turn = model.base.max_acceleration.y() * h;
      speed[dof - 1] += std::clamp(command[dof - 1] - speed[dof - 1], -turn, turn);
      VectorX v = VectorX::Zero(model.num_velocities());
      v.head(dof) = speed;
      integrate(model, base, q, v, h);
    }
  }
};

TEST(OdePlant, RestsWithoutSaggingOrDrifting) {
  for (const char* name : {"frankie", "frankie_omni", "panda", "ur5", "lift_ur5"}) {
    const auto model = robot(name);
    const auto plant = make_plant(model, empty_world(*model), kDynamicMode);
    PlantReport report;
    plant->check_start(report);
    EXPECT_TRUE(report.contacts.empty()) << name;
    for (int k = 0; k < 100; ++k) {
      plant->advance(VectorX::Zero(model->num_velocities()), 0.02, report);
      ASSERT_FALSE(report.diverged) << name << ": " << report.reason;
      ASSERT_FALSE(report.tipped) << name;
      ASSERT_TRUE(report.contacts.empty()) << name;
      ASSERT_EQ(report.lcp_messages, 0) << name;
    }
    EXPECT_LT((plant->state().q - model->ready).lpNorm<Eigen::Infinity>(), 3e-6) << name;
    EXPECT_LT(plant->state().base.norm(), 1e-5) << name;
    EXPECT_NEAR(plant->time(), 2.0, 1e-9);
  }
}

TEST(OdePlant, ArmFollowsTheIntegratedCommand) {
  for (const char* name : {"panda", "frankie", "ur5", "lift_ur5"}) {
    const auto model = robot(name);
    const auto plant = make_plant(model, empty_world(*model), kDynamicMode);
    VectorX q = model->ready;
    PlantReport report;
    double worst = 0.0, worst_speed = 0.0, energy = 0.0;
    const int n = model->num_joints();
    for (int k = 0; k < 250; ++k) {
      VectorX command = VectorX::Zero(model->num_velocities());
      for (int j = 0; j < n; ++j) {
        const double top = std::min(0.4, 0.5 * model->joints[static_cast<std::size_t>(j)].velocity);
        command[model->base_dof() + j] = top * std::sin(0.02 * k * 1.3) * std::sin(j + 1.0);
      }
      plant->advance(command, 0.02, report);
      q += 0.02 * command.tail(n);
      worst = std::max(worst, (plant->state().q - q).lpNorm<Eigen::Infinity>());
      worst_speed = std::max(worst_speed, (plant->state().qdot.tail(n) - command.tail(n)).lpNorm<Eigen::Infinity>());
      energy += report.energy;
    }
    EXPECT_LT(worst, 1e-5) << name;
    EXPECT_LT(worst_speed, 1e-4) << name;
    EXPECT_GT(energy, 1.0) << name << ": moving against gravity takes work";
  }
}

TEST(OdePlant, MotorsOfTheUr5HoldItsAccelerations) {
  // The arm stretched out, where motors have least to spare, and near there; all joints speed up at their limits at
  // once, those that lift it upwards.
  Draws draws(12, 0, Stream::kStart);
  for (const char* name : {"ur5", "lift_ur5"}) {
    const auto model = robot(name);
    const int n = model->num_joints();
    for (int trial = 0; trial < 20; ++trial) {
      World world = empty_world(*model);
      world.start.q.tail(6) << 0, -0.63, 0.36, -0.99, 0.34, 0.18;
      VectorX change = VectorX::Zero(model->num_velocities());
      for (int j = 0; j < 6; ++j) {
        world.start.q[n - 6 + j] += draws.uniform(-0.2, 0.2);
        const bool lifts = j >= 1 && j <= 3;
        const double direction = lifts || draws.uniform(-1.0, 1.0) < 0.0 ? -1.0 : 1.0;
        change[change.size() - 6 + j] = direction * 0.02 * model->joint(n - 6 + j).acceleration;
      }
      const auto plant = make_plant(model, world, kDynamicMode);
      PlantReport report;
      for (int k = 1; k <= 8; ++k) {
        plant->advance(k * change, 0.02, report);
        EXPECT_LT((plant->state().qdot - k * change).lpNorm<Eigen::Infinity>(), 1e-3)
            << name << ", posture " << world.start.q.transpose() << ", after " << k << " periods";
      }
    }
  }
}

TEST(OdePlant, MotorEnergyIsTheWorkDone) {
  // A joint that lifts its arm slowly: work against gravity and back again.
  const auto model = robot("panda");
  World world = empty_world(*model);
  world.start.q << 0, 1.0, 0, -0.8, 0, 1.8, 0.7;
  const auto plant = make_plant(model, world, kDynamicMode);
  const RigidBodies bodies = rigid_bodies(*model, 0.0);
  const auto potential = [&] {
    Kinematics kinematics(model);
    kinematics.update(plant->state().base, plant->state().q);
    double sum = 0.0;
    for (const RigidBody& body : bodies.bodies) sum += 9.81 * body.mass * (kinematics.X_WL(body.link) * body.com_L).z();
    return sum;
  };
  const double before = potential();
  VectorX command = VectorX::Zero(7);
  PlantReport report;
  double energy = 0.0;
  for (int k = 0; k < 100; ++k) {
    command[1] = -0.3 * std::sin(std::numbers::pi * k / 100.0);  // up; at rest at both ends
    plant->advance(command, 0.02, report);
    energy += report.energy;
  }
  command[1] = 0.0;
  plant->advance(command, 0.02, report);
  energy += report.energy;
  EXPECT_GT(potential() - before, 5.0);
  EXPECT_NEAR(energy, potential() - before, 0.02 * (potential() - before));
}

TEST(OdePlant, BaseFollowsItsArcWithoutSlip) {
  for (const char* name : {"frankie", "frankie_omni"}) {
    const auto model = robot(name);
    const auto plant = make_plant(model, empty_world(*model), kDynamicMode);
    RampedBase expected;
    PlantReport report;
    double slip = 0.0;
    for (int k = 0; k < 250; ++k) {
      VectorX command = VectorX::Zero(model->num_velocities());
      if (k < 200) {
        command[0] = 0.4;
        if (model->base_dof() == 3) command[1] = -0.2;
        command[model->base_dof() - 1] = k < 100 ? 0.7 : -0.4;
      }
      plant->advance(command, 0.02, report);
      expected.advance(*model, command, 0.02);
      slip = std::max(slip, report.slip_max);
      ASSERT_LT((plant->state().base - expected.base).head<2>().norm(), 1e-4) << name << " step " << k;
      ASSERT_LT(std::abs(plant->state().base.z() - expected.base.z()), 1e-4) << name << " step " << k;
      // While it ramps, the body has the mean speed of the last step.
      const double half_step = 0.5 * kDynamicMode.physics_step * model->base.max_acceleration.norm();
      ASSERT_LT((plant->state().qdot.head(model->base_dof()) - expected.speed).norm(),
                1e-3 + (expected.ramps ? half_step : 0.0))
          << name << " step " << k;
    }
    EXPECT_LT(slip, 1e-3) << name;
    EXPECT_GT(expected.base.head<2>().norm(), 1.0);
  }
}

TEST(OdePlant, HeadingIsNotWrapped) {
  const auto model = robot("frankie");
  const auto plant = make_plant(model, empty_world(*model), kDynamicMode);
  VectorX command = VectorX::Zero(model->num_velocities());
  command[1] = 1.5;
  PlantReport report;
  for (int k = 0; k < 250; ++k) plant->advance(command, 0.02, report);
  EXPECT_NEAR(plant->state().base.z(), 1.5 * 5.0 - 0.5 * 1.5 * 1.5 / 4.0, 0.01);
}

TEST(OdePlant, JointsBeyondAHalfTurnAreNotWrapped) {
  const auto model = robot("ur5");
  const auto plant = make_plant(model, empty_world(*model), kDynamicMode);
  VectorX command = VectorX::Zero(model->num_velocities());
  PlantReport report;
  double q = model->ready[5];
  for (int k = 0; k < 250; ++k) {
    command[5] = std::min(1.0, 0.05 * k);
    plant->advance(command, 0.02, report);
    q += 0.02 * command[5];
  }
  EXPECT_GT(q, 4.0);
  EXPECT_NEAR(plant->state().q[5], q, 1e-3);
}

TEST(OdePlant, StopsAtJointLimitsWithoutAKick) {
  const auto model = robot("panda");
  const auto plant = make_plant(model, empty_world(*model), kDynamicMode);
  const double upper = model->joints[3].upper;
  VectorX command = VectorX::Zero(7);
  PlantReport report;
  for (int k = 0; k < 200; ++k) {
    command[3] = 2.0;
    plant->advance(command, 0.02, report);
    ASSERT_LT(plant->state().q[3], upper + 0.005);
  }
  EXPECT_NEAR(plant->state().q[3], upper, 0.002);
  command[3] = -0.05;  // away from the limit: no jump
  for (int k = 0; k < 20; ++k) {
    plant->advance(command, 0.02, report);
    ASSERT_LT(std::abs(plant->state().qdot[3]), 0.06);
  }
}

TEST(OdePlant, FindsTheBoxItDrivesIntoAndIsStoppedByIt) {
  const auto model = robot("frankie");
  World world = empty_world(*model);
  world.objects = {solid("box", ShapeKind::kBox, {0.2, 2.0, 0.6}, {1.1, 0.0, 0.3})};
  const double gap = test::base_gap(*model, world.objects[0]);
  const auto plant = make_plant(model, world, kDynamicMode);
  VectorX command = VectorX::Zero(model->num_velocities());
  command[0] = 0.5;
  PlantReport report;
  double first = -1.0;
  for (int k = 0; k < 100; ++k) {
    plant->advance(command, 0.02, report);
    for (const Contact& contact : report.contacts) {
      EXPECT_EQ(contact.kind, PairKind::kObject);
      if (first < 0.0 && model->shapes[static_cast<std::size_t>(contact.first)].link == 0) first = contact.time;
    }
    ASSERT_FALSE(report.diverged) << report.reason;
  }
  // The ramp of 0.25 s to 0.5 m/s costs half of it.
  EXPECT_NEAR(first, gap / 0.5 + 0.125, 0.005);
  EXPECT_LT(plant->state().base.x(), gap + 0.02) << "a box is solid";
}

TEST(OdePlant, AMovingObjectHitsARobotAtRest) {
  const auto model = robot("frankie");
  World world = empty_world(*model);
  world.objects = {solid("ball", ShapeKind::kSphere, {0.1, 0, 0}, {2.0, 0.0, 0.2})};
  const double gap = test::base_gap(*model, world.objects[0]);
  LinearMotion motion;
  motion.V_W[3] = -1.0;
  world.objects[0].motion = motion;
  const auto plant = make_plant(model, world, kDynamicMode);
  PlantReport report;
  double first = -1.0;
  for (int k = 0; k < 100 && first < 0.0; ++k) {
    plant->advance(VectorX::Zero(model->num_velocities()), 0.02, report);
    if (!report.contacts.empty()) first = report.contacts.front().time;
  }
  EXPECT_NEAR(first, gap / 1.0, 0.003);
}

std::vector<double> run(const std::shared_ptr<const RobotModel>& model, int trial) {
  static const Worlds source = test::worlds("seed: 6\nfamilies: {clutter: {}, moving: {}}");
  const auto plant = make_plant(model, source.make(model, static_cast<std::uint64_t>(trial)), kDynamicMode);
  std::vector<double> out;
  PlantReport report;
  for (int k = 0; k < 60; ++k) {
    VectorX command(model->num_velocities());
    for (Eigen::Index i = 0; i < command.size(); ++i)
      command[i] = 0.5 * std::sin(0.1 * k + static_cast<double>(i + trial));
    plant->advance(command, 0.02, report);
    const PlantState& s = plant->state();
    out.insert(out.end(), s.base.data(), s.base.data() + 3);
    out.insert(out.end(), s.q.data(), s.q.data() + s.q.size());
    out.insert(out.end(), s.qdot.data(), s.qdot.data() + s.qdot.size());
    out.push_back(report.energy);
    out.push_back(report.slip_max);
    out.push_back(static_cast<double>(report.contacts.size()));
  }
  return out;
}

TEST(OdePlant, ThreadsAndOrderChangeNoBit) {
  const auto model = robot("frankie");
  constexpr int kTrials = 8;
  std::vector<std::vector<double>> serial, parallel(kTrials);
  for (int i = 0; i < kTrials; ++i) serial.push_back(run(model, i));
  std::vector<std::thread> pool;
  for (int t = 0; t < 2; ++t)
    pool.emplace_back([&, t] {
      for (int i = kTrials - 1 - t; i >= 0; i -= 2) parallel[static_cast<std::size_t>(i)] = run(model, i);
    });
  for (std::thread& thread : pool) thread.join();
  for (std::size_t i = 0; i < kTrials; ++i) EXPECT_EQ(serial[i], parallel[i]) << "trial " << i;
}

TEST(OdePlant, ATopHeavyRobotTips) {
  RobotModel light = *robot("frankie");
  light.base.mass = 3.0;
  auto model = std::make_shared<const RobotModel>(light);
  World world = empty_world(*model);
  world.start.q << 1.57, 1.3, 0, -0.3, 0, 2.0, 0.7;  // stretched out to the side
  const auto plant = make_plant(model, world, kDynamicMode);
  PlantReport report;
  bool tipped = false;
  for (int k = 0; k < 150 && !tipped; ++k) {
    plant->advance(VectorX::Zero(model->num_velocities()), 0.02, report);
    tipped = report.tipped;
    ASSERT_FALSE(report.diverged) << report.reason;
  }
  EXPECT_TRUE(tipped);
  EXPECT_NE(report.reason.find("30 degrees"), std::string::npos) << report.reason;
}

TEST(OdePlant, TooFastIsDivergedAndStaysSo) {
  RobotModel wild = *robot("panda");
  for (ControlledJoint& joint : wild.joints) {
    joint.velocity = 1e6;
    joint.effort = 1e9;
    joint.type = JointType::kContinuous;
    joint.lower = -std::numeric_limits<double>::infinity();
    joint.upper = std::numeric_limits<double>::infinity();
  }
  auto model = std::make_shared<const RobotModel>(wild);
  const auto plant = make_plant(model, empty_world(*model), kDynamicMode);
  PlantReport report;
  VectorX command = VectorX::Constant(7, 3000.0);
  plant->advance(command, 0.02, report);
  EXPECT_TRUE(report.diverged);
  EXPECT_FALSE(report.reason.empty());
  plant->advance(VectorX::Zero(7), 0.02, report);
  EXPECT_TRUE(report.diverged);
}

TEST(OdePlant, RefusesACommandThatIsNotFinite) {
  const auto model = robot("frankie");
  const auto plant = make_plant(model, empty_world(*model), kDynamicMode);
  VectorX command = VectorX::Zero(model->num_velocities());
  command[0] = std::numeric_limits<double>::quiet_NaN();
  PlantReport report;
  EXPECT_THROW(plant->advance(command, 0.02, report), std::invalid_argument);
  command[0] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(plant->advance(command, 0.02, report), std::invalid_argument);
  command[0] = 0.1;
  plant->advance(command, 0.02, report);
  EXPECT_FALSE(report.diverged) << "the plant is unharmed";
}

TEST(OdePlant, SaysWhatTheRobotLacks) {
  const RobotModel good = *robot("frankie");
  const auto refused = [&](auto change, const char* part) {
    RobotModel bad = good;
    change(bad);
    try {
      make_plant(std::make_shared<const RobotModel>(bad), empty_world(bad), kDynamicMode);
      ADD_FAILURE() << "accepted without " << part;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
    EXPECT_NO_THROW(
        make_plant(std::make_shared<const RobotModel>(bad), empty_world(bad), {SimulationMode::kKinematic}));
  };
  refused([](RobotModel& m) { m.joints[2].effort = 0.0; }, "arm.limits.panda_joint3.effort");
  refused([](RobotModel& m) { m.links[static_cast<std::size_t>(m.joints[1].link)].inertial.reset(); }, "panda_link2");
  refused([](RobotModel& m) { m.links[static_cast<std::size_t>(m.joints[1].link)].inertial->I_C.setZero(); },
          "panda_link2");
  refused([](RobotModel& m) { m.base.mass = 0.0; }, "base.footprint.mass");
  refused([](RobotModel& m) { m.base.wheels.reset(); }, "base.wheels");
}

TEST(OdeRuntime, CountsLcpMessagesAndThrowsOnInternalErrors) {
  ode::use_on_this_thread();
  ode::take_lcp_messages();
  dMessage(d_ERR_LCP, "LCP internal error, s <= 0 (s=%.4e)", 0.0);
  dMessage(d_ERR_UNKNOWN, "something else");
  int other = -1;
  std::thread thread([&] {
    ode::use_on_this_thread();
    dMessage(d_ERR_LCP, "in another thread");
    other = ode::take_lcp_messages();
  });
  thread.join();
  EXPECT_EQ(other, 1);
  EXPECT_EQ(ode::take_lcp_messages(), 1) << "per thread";
  EXPECT_EQ(ode::take_lcp_messages(), 0);
  EXPECT_THROW(dDebug(d_ERR_IASSERT, "assertion %d", 7), ode::Fault);
  EXPECT_THROW(dError(d_ERR_UASSERT, "bad argument"), ode::Fault);
}

TEST(RigidBodies, KeepTheRobotsMassAndCentre) {
  const auto model = robot("frankie");
  const RigidBodies merged = rigid_bodies(*model, model->base.mass);
  EXPECT_EQ(merged.bodies.size(), 8u) << "base and seven links; what is fixed is merged";
  Kinematics kinematics(model);
  VectorX q = model->ready;
  q.array() += 0.2;
  kinematics.update(Vector3(1.0, -2.0, 0.7), q);
  double mass = model->base.mass, mass_merged = 0.0;
  // The base's mass fills its footprint, a capsule, and its wheels, two boxes, evenly.
  const Vector3 capsule = model->shapes[0].shape.size;
  const double footprint = std::numbers::pi * capsule[0] * capsule[0] * (capsule[1] + 4.0 / 3.0 * capsule[0]);
  const double wheels = 2.0 * model->shapes[1].shape.size.prod();
  for (int i = 0; i < 3; ++i) ASSERT_EQ(model->shapes[static_cast<std::size_t>(i)].link, 0);
  const Vector3 axle(0.0, 0.0, model->base.wheels->radius);
  const Vector3 com_B = (footprint * model->shapes[0].X_LS.translation() + wheels * axle) / (footprint + wheels);
  Vector3 moment = model->base.mass * (kinematics.X_WB() * com_B);
  Vector3 moment_merged = Vector3::Zero();
  for (std::size_t i = 0; i < model->links.size(); ++i) {
    if (!model->links[i].inertial) continue;
    mass += model->links[i].inertial->mass;
    moment += model->links[i].inertial->mass * (kinematics.X_WL(static_cast<int>(i)) * model->links[i].inertial->com_L);
  }
  for (const RigidBody& body : merged.bodies) {
    mass_merged += body.mass;
    moment_merged += body.mass * (kinematics.X_WL(body.link) * body.com_L);
  }
  EXPECT_NEAR(mass, mass_merged, 1e-12);
  EXPECT_LT((moment - moment_merged).norm(), 1e-10);
}

}  // namespace
}  // namespace moma
