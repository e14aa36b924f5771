#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "tests/world/support.h"
#include "world/plant/plant.h"

namespace moma {
namespace {

using test::empty_world;
using test::robot;
using test::solid;

constexpr SimulationConfig kKinematic{SimulationMode::kKinematic};

TEST(KinematicPlant, IsTheExactIntegral) {
  for (const char* name : {"frankie", "frankie_omni", "panda", "lift_ur5"}) {
    const auto model = robot(name);
    const auto plant = make_plant(model, empty_world(*model), kKinematic);
    Vector3 base = Vector3::Zero();
    VectorX q = model->ready;
    PlantReport report;
    for (int k = 0; k < 50; ++k) {
      VectorX command(model->num_velocities());
      for (Eigen::Index i = 0; i < command.size(); ++i) command[i] = 0.2 * std::sin(0.3 * k + static_cast<double>(i));
      plant->advance(command, 0.02, report);
      integrate(*model, base, q, command, 0.02);
      ASSERT_EQ(plant->state().base, base) << name;
      ASSERT_EQ(plant->state().q, q) << name;
      ASSERT_EQ(plant->state().qdot, command) << name;
    }
    EXPECT_NEAR(plant->time(), 1.0, 1e-12);
  }
}

TEST(KinematicPlant, FindsTheBoxItDrivesInto) {
  const auto model = robot("frankie");
  World world = empty_world(*model);
  world.objects = {solid("box", ShapeKind::kBox, {0.2, 2.0, 0.6}, {1.1, 0.0, 0.3})};
  const double gap = test::base_gap(*model, world.objects[0]);
  const auto plant = make_plant(model, world, kKinematic);
  PlantReport report;
  plant->check_start(report);
  EXPECT_TRUE(report.contacts.empty());
  VectorX command = VectorX::Zero(model->num_velocities());
  command[0] = 0.5;
  double first = -1.0;
  for (int k = 0; k < 100 && first < 0.0; ++k) {
    plant->advance(command, 0.02, report);
    for (const Contact& contact : report.contacts) {
      if (model->shapes[static_cast<std::size_t>(contact.first)].link != 0) continue;
      EXPECT_EQ(contact.kind, PairKind::kObject);
      EXPECT_EQ(contact.second, 0);
      EXPECT_TRUE(contact.by_ode);
      first = contact.time;
    }
  }
  EXPECT_NEAR(first, gap / 0.5, 0.0051) << "at 0.5 m/s, checked every 5 ms";
}

TEST(KinematicPlant, SeesWhatPassesBetweenTwoControlSteps) {
  const auto model = robot("panda");
  World world = empty_world(*model);
  // A ball flies through the arm: inside it only between 0.3 and 0.7 of the step.
  world.objects = {solid("ball", ShapeKind::kSphere, {0.05, 0.0, 0.0}, {0.0, -1.0, 0.2})};
  LinearMotion motion;
  motion.V_W[4] = 20.0;
  world.objects[0].motion = motion;
  const auto plant = make_plant(model, world, kKinematic);
  PlantReport report;
  plant->check_start(report);
  EXPECT_TRUE(report.contacts.empty());
  plant->advance(VectorX::Zero(model->num_velocities()), 0.1, report);
  EXPECT_FALSE(report.contacts.empty());
}

TEST(KinematicPlant, FindsFloorAndSelfContact) {
  const auto model = robot("panda");
  World world = empty_world(*model);
  world.start.q = (VectorX(7) << 0, 1.7, 0, -1.5, 0, 1.5, 0).finished();  // forearm down
  PlantReport report;
  make_plant(model, world, kKinematic)->check_start(report);
  bool floor = false;
  for (const Contact& contact : report.contacts)
    floor = floor || (contact.kind == PairKind::kFloor && contact.second == -1);
  EXPECT_TRUE(floor);

  const auto ur5 = robot("ur5");
  World folded = empty_world(*ur5);
  folded.start.q << 0, -1.57, 3.1, 0, 0, 0;  // forearm onto upper arm
  make_plant(ur5, folded, kKinematic)->check_start(report);
  bool self = false;
  for (const Contact& contact : report.contacts) self = self || contact.kind == PairKind::kSelf;
  EXPECT_TRUE(self);
}

TEST(KinematicPlant, RefusesBadCommands) {
  const auto model = robot("frankie");
  const auto plant = make_plant(model, empty_world(*model), kKinematic);
  PlantReport report;
  VectorX command = VectorX::Zero(model->num_velocities());
  command[3] = std::numeric_limits<double>::quiet_NaN();
  try {
    plant->advance(command, 0.02, report);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(model->velocity_names()[3]), std::string::npos) << error.what();
  }
  EXPECT_THROW(plant->advance(VectorX::Zero(2), 0.02, report), std::invalid_argument);
  EXPECT_THROW(plant->advance(VectorX::Zero(model->num_velocities()), -1.0, report), std::invalid_argument);
  World wrong = empty_world(*model);
  wrong.start.q = VectorX::Zero(3);
  EXPECT_THROW(make_plant(model, wrong, kKinematic), std::runtime_error);
}

TEST(KinematicPlant, StopsJointsAtTheirLimitsWhereAsked) {
  const auto model = robot("bare/panda");
  for (const AtJointLimit at : {AtJointLimit::kEnd, AtJointLimit::kClamp, AtJointLimit::kIgnore}) {
    SimulationConfig simulation = kKinematic;
    simulation.joint_limits = at;
    const auto plant = make_plant(model, empty_world(*model), simulation);
    VectorX command = VectorX::Zero(7);
    command[0] = 2.0;
    command[3] = 2.0;  // from -2.2 to -0.0698 takes more than a second
    PlantReport report;
    for (int k = 0; k < 40; ++k) plant->advance(command, 0.05, report);
    const VectorX& q = plant->state().q;
    EXPECT_NEAR(q[0], at == AtJointLimit::kClamp ? model->joints[0].upper : 4.0, 1e-9);
    EXPECT_NEAR(q[3], at == AtJointLimit::kClamp ? model->joints[3].upper : 1.8, 1e-9);
    EXPECT_EQ(q[1], model->ready[1]);
  }
}

/// Two plants, one of which looks at every pair at each check, through the same commands; contacts end nothing, so that
/// they are driven through objects, the floor and themselves.
struct Both {
  std::unique_ptr<Plant> some, all;
  int contacts = 0, clear = 0;

  Both(const std::shared_ptr<const RobotModel>& model, const World& world, bool stops)
      : some(make_kinematic_plant(model, world, stops)),
        all(make_kinematic_plant(model, world, stops, ContactChecks::kAll)) {}

  void advance(const VectorX& command, double duration, const std::string& where) {
    PlantReport a, b;
    some->advance(command, duration, a);
    all->advance(command, duration, b);
    ASSERT_EQ(some->state().base, all->state().base) << where;
    ASSERT_EQ(some->state().q, all->state().q) << where;
    ASSERT_EQ(a.contacts.size(), b.contacts.size()) << where;
    for (std::size_t i = 0; i < a.contacts.size(); ++i) {
      const Contact &x = a.contacts[i], &y = b.contacts[i];
      ASSERT_EQ(std::tie(x.kind, x.first, x.second, x.depth, x.time, x.by_ode),
                std::tie(y.kind, y.first, y.second, y.depth, y.time, y.by_ode))
          << where;
    }
    const DetectorCheck c = some->cross_check(), d = all->cross_check();
    ASSERT_EQ(c.disagreements, d.disagreements) << where;
    ASSERT_EQ(c.deepest, d.deepest) << where;
    (a.contacts.empty() ? clear : contacts) += 1;
  }
};

TEST(KinematicPlant, FindsTheContactsThatLookingAtEverythingFinds) {
  constexpr std::array kWorlds = {"open: {}", "clutter: {objects: 12, shapes: [sphere, box, capsule]}",
                                  "moving: {walk: 0.4, orbit: 0.3}", "shelf: {}", "table: {}"};
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int contacts = 0, clear = 0;
  for (const char* name : {"frankie", "frankie_omni", "panda", "lift_ur5", "ur5"}) {
    const auto model = robot(name);
    for (const char* family : kWorlds) {
      const Worlds source = test::worlds(fmt::format("seed: 5\nfamilies: {{{}}}", family));
      if (test::is_for_others(source, model)) continue;
      for (std::uint64_t index = 0; index < 2; ++index) {
        World world = source.make(model, index);
        // One that ODE does not decide about.
        world.objects.push_back(solid("can", ShapeKind::kCylinder, {0.1, 0.4, 0.0}, {0.8, 0.5, 0.6}));
        for (const double period : {0.004, 0.02, 0.13}) {
          Both both(model, world, index == 1);
          const VectorX most = model->velocity_limits();
          VectorX command = VectorX::Zero(most.size());
          for (int k = 0; k < 150; ++k) {
            // Full speed and more towards anywhere, for a while; at rest now and then.
            if (k % 15 == 0)
              for (Eigen::Index i = 0; i < command.size(); ++i)
                command[i] = k % 60 == 45 ? 0.0 : 1.5 * unit(random) * std::min(most[i], 3.0);
            both.advance(command, period,
                         fmt::format("{}, {}, world {}, step {} of {} s", name, family, index, k, period));
            if (HasFatalFailure()) return;
          }
          contacts += both.contacts;
          clear += both.clear;
        }
      }
    }
  }
  EXPECT_GT(contacts, 2000);
  EXPECT_GT(clear, 2000);
}

// In both plants: what is carried touches a wall that the hand passes, and, left, is touched by the hand that lowers.
TEST(PlantsThatCarry, ObjectsTouchAndAreTouched) {
  for (const SimulationMode mode : {SimulationMode::kKinematic, SimulationMode::kDynamic}) {
    const auto model = robot("frankie");
    World world = empty_world(*model);
    Kinematics kinematics(model);
    kinematics.update(world.start.base, world.start.q);
    const Isometry X_WE = kinematics.X_WE();
    Carried carried;
    carried.X_EO.translation().z() = 0.12;
    const Vector3 at = X_WE * carried.X_EO.translation();
    world.objects = {solid("cup", ShapeKind::kBox, Vector3::Constant(0.06), at),
                     solid("wall", ShapeKind::kBox, {0.02, 0.4, 0.03}, at + Vector3(0.14, 0.0, -0.03))};
    SimulationConfig simulation;
    simulation.mode = mode;
    VectorX forward = VectorX::Zero(model->num_velocities());
    forward[0] = 0.2;
    PlantReport report;
    const auto drive = [&](Plant& plant, const VectorX& command, int most) {
      report = {};
      for (int k = 0; k < most && report.contacts.empty(); ++k) plant.advance(command, 0.02, report);
    };
    const auto hit = make_plant(model, world, simulation);
    hit->carry(carried);
    drive(*hit, forward, 60);
    ASSERT_EQ(report.contacts.size(), 1u) << to_string(mode);
    EXPECT_EQ(report.contacts[0].first, static_cast<int>(model->shapes.size()));
    EXPECT_EQ(report.contacts[0].second, 1);
    EXPECT_NEAR(hit->state().base.x(), 0.1, 0.02);
    EXPECT_EQ(hit->cross_check().disagreements, 0);

    world.objects.pop_back();
    const auto left = make_plant(model, world, simulation);
    left->carry(carried);
    drive(*left, forward, 25);
    ASSERT_TRUE(report.contacts.empty());
    left->carry({});
    const double x = left->state().base.x();
    drive(*left, VectorX::Zero(model->num_velocities()), 25);
    ASSERT_TRUE(report.contacts.empty());
    Vector6 down = Vector6::Zero();
    down.tail<3>() = 0.1 * X_WE.linear().col(2);
    VectorX lower = VectorX::Zero(model->num_velocities());
    lower.tail(model->num_joints()) =
        kinematics.J_WE_W().rightCols(model->num_joints()).completeOrthogonalDecomposition().solve(down);
    drive(*left, lower, 60);
    ASSERT_FALSE(report.contacts.empty()) << to_string(mode) << ": it stands where it was left, " << x << " m on";
    EXPECT_EQ(report.contacts[0].second, 0);
    EXPECT_LT(report.contacts[0].first, static_cast<int>(model->shapes.size()));
  }
}

}  // namespace
}  // namespace moma
