// Payload, floor friction and joint friction: against what mechanics says, and in their draws.
#include "world/sensing/sensing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/world/support.h"
#include "world/plant/rigid_bodies.h"

namespace moma {
namespace {

using test::empty_world;
using test::robot;

constexpr double kGravity = 9.81;
const SimulationConfig kDynamic;

/// Plays a constant command for `duration` and returns the plant.
std::unique_ptr<Plant> play(const std::shared_ptr<const RobotModel>& model, const World& world,
                            const PlantConditions& conditions, const VectorX& command, double duration,
                            PlantReport* total = nullptr) {
  auto plant = make_plant(model, world, kDynamic, conditions);
  PlantReport report;
  while (plant->time() < duration - 1e-9) {
    plant->advance(command, 0.02, report);
    EXPECT_FALSE(report.diverged) << report.reason;
    EXPECT_EQ(report.lcp_messages, 0);
    if (total == nullptr) continue;
    total->energy += report.energy;
    total->slip_max = std::max(total->slip_max, report.slip_max);
  }
  return plant;
}

/// The UR5 on its column, whose column alone is weak: it moves `mass` by at most `effort` newtons.
struct Column {
  std::shared_ptr<const RobotModel> model;
  double mass = 0.0;
  int joint = 0;
  explicit Column(double effort_of_weight) {
    RobotModel changed = *robot("lift_ur5");
    while (changed.joints[static_cast<std::size_t>(joint)].type != JointType::kPrismatic) ++joint;
    const RigidBodies bodies = rigid_bodies(changed, changed.base.mass);
    for (const RigidBody& body : bodies.bodies) mass += body.joint < 0 ? 0.0 : body.mass;
    ControlledJoint& column = changed.joints[static_cast<std::size_t>(joint)];
    column.effort = effort_of_weight * mass * kGravity;
    column.velocity = 100.0;
    column.upper = 50.0;
    column.lower = -50.0;
    model = std::make_shared<const RobotModel>(changed);
  }
  VectorX command(double speed) const {
    VectorX v = VectorX::Zero(model->num_velocities());
    v[model->base_dof() + joint] = speed;
    return v;
  }
  /// Friction of the column alone, as a part of the weight.
  PlantConditions friction(double of_weight) const {
    PlantConditions conditions;
    conditions.joint_friction = VectorX::Zero(model->num_joints());
    conditions.joint_friction[joint] = of_weight * mass * kGravity;
    return conditions;
  }
  double speed(const Plant& plant) const { return plant.state().qdot[model->base_dof() + joint]; }
};

TEST(PlantConditions, DryFrictionTakesItsForceFromASlider) {
  const Column column(1.5);
  constexpr double kTime = 0.2;
  for (const double f : {0.0, 0.1, 0.3}) {
    // m a = effort - friction - weight, all as parts of the weight.
    const auto plant = play(column.model, empty_world(*column.model), column.friction(f), column.command(50.0), kTime);
    const double expected = (1.5 - f - 1.0) * kGravity * kTime;
    EXPECT_NEAR(column.speed(*plant), expected, 2e-3 * kGravity * kTime) << "friction of " << f << " of the weight";
  }
  // Downwards it holds back just as much: m a = -effort + friction - weight.
  World high = empty_world(*column.model);
  high.start.q[column.joint] += 1.0;
  const auto down = play(column.model, high, column.friction(0.3), column.command(-50.0), kTime);
  EXPECT_NEAR(column.speed(*down), (-1.5 + 0.3 - 1.0) * kGravity * kTime, 2e-3 * kGravity * kTime);
}

TEST(PlantConditions, DryFrictionSticksUpToItsForceAndNoFurther) {
  const Column weak(1e-6);  // as good as no motor
  const auto holds = play(weak.model, empty_world(*weak.model), weak.friction(1.1), weak.command(0.0), 1.0);
  EXPECT_NEAR(holds->state().q[weak.joint], weak.model->ready[weak.joint], 1e-6) << "friction holds the weight";
  const auto slides = play(weak.model, empty_world(*weak.model), weak.friction(0.6), weak.command(0.0), 0.2);
  EXPECT_NEAR(weak.speed(*slides), -0.4 * kGravity * 0.2, 5e-3) << "and no more than its own force";
}

TEST(PlantConditions, DryFrictionTakesItsTorqueFromAHinge) {
  // About the first joint, which stands upright, nothing but motor and friction acts. The rest of the arm is held.
  RobotModel changed = *robot("panda");
  changed.joints[0].effort = 2.0;
  changed.joints[0].velocity = 100.0;
  const auto model = std::make_shared<const RobotModel>(changed);
  VectorX command = VectorX::Zero(7);
  command[0] = 50.0;
  const auto speed = [&](double friction) {
    PlantConditions conditions;
    conditions.joint_friction = VectorX::Zero(7);
    conditions.joint_friction[0] = friction;
    return play(model, empty_world(*model), conditions, command, 0.2)->state().qdot[0];
  };
  const double free = speed(0.0);
  EXPECT_GT(free, 0.1);
  EXPECT_NEAR(speed(0.5) / free, 0.75, 5e-3);
  EXPECT_NEAR(speed(1.5) / free, 0.25, 5e-3);
  EXPECT_NEAR(speed(2.5), 0.0, 1e-6) << "stuck";
}

TEST(PlantConditions, AStrongMotorDoesNotNoticeFrictionButPaysForIt) {
  for (const char* name : {"frankie", "ur5"}) {
    const auto model = robot(name);
    PlantConditions rough;
    rough.joint_friction.resize(model->num_joints());
    for (int i = 0; i < model->num_joints(); ++i)
      rough.joint_friction[i] = 0.2 * model->joints[static_cast<std::size_t>(i)].effort;
    VectorX command = VectorX::Zero(model->num_velocities());
    command.tail(model->num_joints()).setConstant(0.1);
    PlantReport smooth_total, rough_total;
    const auto smooth = play(model, empty_world(*model), {}, command, 1.0, &smooth_total);
    const auto plant = play(model, empty_world(*model), rough, command, 1.0, &rough_total);
    EXPECT_LT((plant->state().q - smooth->state().q).lpNorm<Eigen::Infinity>(), 1e-4)
        << name << ": but for the first steps, where the command jumps";
    const double work = 0.1 * rough.joint_friction.sum();  // 0.1 rad of each
    EXPECT_GT(rough_total.energy, smooth_total.energy + 0.3 * work) << name;
    EXPECT_LT(rough_total.energy, smooth_total.energy + 1.01 * work) << name;
  }
}

TEST(PlantConditions, APayloadIsHeldUpToWhatTheMotorsCan) {
  const auto model = robot("panda");
  World world = empty_world(*model);
  world.start.q << 0, 1.2, 0, -0.6, 0, 1.8, 0.7;  // stretched out
  const auto sag = [&](double mass) {
    PlantConditions conditions;
    conditions.payload.mass = mass;
    const auto plant = play(model, world, conditions, VectorX::Zero(7), 0.5);
    return (plant->state().q - world.start.q).lpNorm<Eigen::Infinity>();
  };
  EXPECT_LT(sag(3.0), 1e-5) << "what the maker allows";
  // At joint 2 (87 Nm) 20 kg nearly a metre away are too much.
  EXPECT_GT(sag(20.0), 0.05);
}

TEST(PlantConditions, APayloadsWeightStandsInTheWorkOfLiftingIt) {
  const auto model = robot("panda");
  World world = empty_world(*model);
  world.start.q << 0, 1.0, 0, -0.8, 0, 1.8, 0.7;
  const Vector3 p_EP_E(0.05, 0.0, 0.1);
  const auto lift = [&](double mass, double& height) {
    PlantConditions conditions;
    conditions.payload = {mass, p_EP_E};
    const auto plant = make_plant(model, world, kDynamic, conditions);
    PlantReport report;
    double energy = 0.0;
    VectorX command = VectorX::Zero(7);
    for (int k = 0; k <= 100; ++k) {
      command[1] = k < 100 ? -0.3 * std::sin(std::numbers::pi * k / 100.0) : 0.0;  // at rest at both ends
      plant->advance(command, 0.02, report);
      energy += report.energy;
    }
    Kinematics kinematics(model);
    kinematics.update(world.start.base, world.start.q);
    height = -(kinematics.X_WE() * p_EP_E).z();
    kinematics.update(plant->state().base, plant->state().q);
    height += (kinematics.X_WE() * p_EP_E).z();
    return energy;
  };
  double height = 0.0;
  const double empty = lift(0.0, height);
  const double loaded = lift(2.0, height);
  ASSERT_GT(height, 0.1);
  EXPECT_NEAR(loaded - empty, 2.0 * kGravity * height, 0.02 * 2.0 * kGravity * height);
}

TEST(PlantConditions, TheFloorPassesOnItsFrictionAndNoMore) {
  for (const char* name : {"frankie", "frankie_omni"}) {
    RobotModel eager = *robot(name);
    eager.base.max_acceleration = {1e3, 1e3};
    const auto model = std::make_shared<const RobotModel>(eager);
    VectorX command = VectorX::Zero(model->num_velocities());
    command[0] = 1.0;
    const auto start = [&](double friction, double& slip) {
      PlantConditions conditions;
      conditions.floor_friction = friction;
      PlantReport total;
      const double speed = play(model, empty_world(*model), conditions, command, 0.2, &total)->state().qdot[0];
      slip = total.slip_max;
      return speed;
    };
    double slip = 0.0;
    const double most = 0.1 * kGravity * 0.2;  // mu g t
    const double slow = start(0.1, slip);
    EXPECT_GT(slip, 0.7) << name;
    EXPECT_LT(slow, 1.01 * most) << name;
    // The casters of the differential drive bear a little of the weight.
    EXPECT_GT(slow, (model->base_dof() == 3 ? 0.99 : 0.8) * most) << name;
    EXPECT_NEAR(start(0.0, slip), 0.0, 1e-3) << name << ": on ice";
  }
}

TEST(PlantConditions, NothingIsDrawnWhereNothingIsOn) {
  const auto model = robot("frankie");
  Disturbances d;
  d.joints.noise = 0.1;
  d.actuators.joints.gain_error = 0.1;
  const PlantConditions conditions = plant_conditions(d, *model, empty_world(*model));
  EXPECT_EQ(conditions.payload.mass, 0.0);
  EXPECT_EQ(conditions.floor_friction, 1.0);
  EXPECT_EQ(conditions.joint_friction.size(), 0);
}

TEST(PlantConditions, EachHasAStreamOfItsOwnAndTheWorldDecides) {
  const auto model = robot("frankie");
  World world = empty_world(*model);
  world.seed = 4;
  Disturbances d;
  d.actuators.joints.friction = {0.1, 0.05};
  const PlantConditions friction = plant_conditions(d, *model, world);
  d.payload = {2.0, 0.5};
  d.floor = {0.8, 0.1};
  const PlantConditions all = plant_conditions(d, *model, world);
  EXPECT_EQ(friction.joint_friction, all.joint_friction);
  EXPECT_EQ(friction.payload.mass, 0.0);
  double masses = 0.0, floors = 0.0, fractions = 0.0;
  constexpr int kWorlds = 2000;
  double squares = 0.0;
  for (int i = 0; i < kWorlds; ++i) {
    world.index = static_cast<std::uint64_t>(i);
    const PlantConditions c = plant_conditions(d, *model, world);
    masses += c.payload.mass / kWorlds;
    squares += std::pow(c.payload.mass - 2.0, 2) / kWorlds;
    floors += c.floor_friction / kWorlds;
    for (int k = 0; k < 7; ++k) {
      const double fraction = c.joint_friction[k] / model->joints[static_cast<std::size_t>(k)].effort;
      ASSERT_GE(fraction, 0.0);
      ASSERT_LE(fraction, 0.95);
      fractions += fraction / (7.0 * kWorlds);
    }
  }
  // Five standard errors.
  EXPECT_NEAR(masses, 2.0, 5 * 0.5 / std::sqrt(kWorlds));
  EXPECT_NEAR(std::sqrt(squares), 0.5, 5 * 0.5 / std::sqrt(2.0 * kWorlds));
  EXPECT_NEAR(floors, 0.8, 5 * 0.1 / std::sqrt(kWorlds));
  EXPECT_NEAR(fractions, 0.1, 5 * 0.05 / std::sqrt(7.0 * kWorlds) + 5e-4);
}

}  // namespace
}  // namespace moma
