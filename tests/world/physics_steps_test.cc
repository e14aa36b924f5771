// Physics steps that are taken back, made without bounds or made large: the answer is that of plain, small ones.
#include <gtest/gtest.h>
#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "tests/world/support.h"
#include "world/plant/gap_watch.h"
#include "world/plant/ode_library.h"
#include "world/plant/plant.h"

namespace moma {
namespace {

using test::empty_world;
using test::robot;
using test::solid;

constexpr std::array<const char*, 5> kRobots = {"frankie", "frankie_omni", "panda", "ur5", "lift_ur5"};

SimulationConfig with_step(double step) {
  SimulationConfig simulation;
  simulation.physics_step = step;
  return simulation;
}

/// Four boxes in a chain with weak motors, tumbling over the floor.
class Tumbling {
 public:
  Tumbling() : contacts_(dJointGroupCreate(0)), space_(ode::make_simple_space()) {
    dWorldSetGravity(world_.id(), 0.0, 0.0, -9.81);
    dWorldSetCFM(world_.id(), 1e-9);
    floor_ = dCreatePlane(space_.get(), 0.0, 0.0, 1.0, 0.0);
    for (int i = 0; i < 4; ++i) {
      const dBodyID body = dBodyCreate(world_.id());
      dMass mass;
      dMassSetBoxTotal(&mass, 1.0 + i, 0.3, 0.2, 0.1);
      dBodySetMass(body, &mass);
      dBodySetFiniteRotationMode(body, 1);
      dBodySetPosition(body, 0.4 * i, 0.05 * i, 0.4);
      dBodySetAngularVel(body, 1.0, -2.0 + i, 0.5);
      const dGeomID geom = dCreateBox(space_.get(), 0.3, 0.2, 0.1);
      dGeomSetBody(geom, body);
      geoms_.push_back(geom);
      states.add(body);
      if (i > 0) {
        const dJointID hinge = dJointCreateHinge(world_.id(), nullptr);
        dJointAttach(hinge, bodies_.back(), body);
        dJointSetHingeAnchor(hinge, 0.4 * i - 0.2, 0.0, 0.4);
        dJointSetHingeAxis(hinge, 0.3, 1.0, 0.2 * i);
        dJointSetHingeParam(hinge, dParamFMax, 3.0);
        dJointSetHingeParam(hinge, dParamVel, 2.0);
      }
      bodies_.push_back(body);
    }
  }

  void collide() {
    dJointGroupEmpty(contacts_.get());
    for (const dGeomID geom : geoms_) {
      dContact contact[4] = {};
      const int n = dCollide(geom, floor_, 4, &contact[0].geom, sizeof(dContact));
      for (int i = 0; i < n; ++i) {
        contact[i].surface.mode = dContactApprox1;
        contact[i].surface.mu = 0.5;
        dJointAttach(dJointCreateContact(world_.id(), contacts_.get(), &contact[i]), dGeomGetBody(geom), nullptr);
      }
      touches += n;
    }
  }
  void step() { dWorldStep(world_.id(), 0.005); }

  /// Every number of every body, and of the boxes around its geom.
  std::vector<double> bits() const {
    std::vector<double> out;
    const auto take = [&out](const dReal* p, int n) { out.insert(out.end(), p, p + n); };
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      take(dBodyGetPosition(bodies_[i]), 3);
      take(dBodyGetQuaternion(bodies_[i]), 4);
      take(dBodyGetRotation(bodies_[i]), 12);
      take(dBodyGetLinearVel(bodies_[i]), 3);
      take(dBodyGetAngularVel(bodies_[i]), 3);
      dReal box[6];
      dGeomGetAABB(geoms_[i], box);
      take(box, 6);
    }
    return out;
  }

  ode::BodyStates states;
  int touches = 0;

 private:
  ode::World world_;
  ode::JointGroup contacts_;
  ode::Space space_;
  dGeomID floor_ = nullptr;
  std::vector<dBodyID> bodies_;
  std::vector<dGeomID> geoms_;
};

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(BodyStates, AStepThatIsTakenBackAndMadeAgainHasTheSameBits) {
  Tumbling scene;
  for (int k = 0; k < 300; ++k) {
    scene.collide();
    const std::vector<double> before = scene.bits();
    scene.states.save();
    scene.step();
    const std::vector<double> once = scene.bits();
    ASSERT_FALSE(same_bits(before, once));
    scene.states.restore();
    ASSERT_TRUE(same_bits(before, scene.bits())) << "step " << k << " is not taken back whole";
    scene.step();
    ASSERT_TRUE(same_bits(once, scene.bits())) << "step " << k << " is another one when made again";
  }
  EXPECT_GT(scene.touches, 100);
}

/// Smooth motion with jumps now and then, as far as `share` of the joints' speeds.
VectorX wild_command(const RobotModel& model, int k, double share) {
  VectorX command(model.num_velocities());
  for (Eigen::Index i = 0; i < command.size(); ++i) {
    const int joint = static_cast<int>(i) - model.base_dof();
    const double top = joint < 0 ? 0.6 : model.joints[static_cast<std::size_t>(joint)].velocity;
    const double jump = (k / 17 + static_cast<int>(i)) % 3 - 1.0;
    command[i] = share * top * (0.5 * std::sin(0.07 * k + 1.3 * static_cast<double>(i)) + 0.5 * jump);
  }
  return command;
}

struct Compared {
  double apart = 0.0, energy = 0.0;
  int redone = 0, redone_by_plain = 0, steps = 0;
};

/// The same commands with the motors' limits always and where they bind.
Compared compare(const std::shared_ptr<const RobotModel>& model, const World& world, const PlantConditions& conditions,
                 double step, double share, int periods) {
  const auto plain = make_ode_plant(model, world, with_step(step), conditions, MotorBounds::kAlways);
  const auto quick = make_ode_plant(model, world, with_step(step), conditions);
  PlantReport a, b;
  Compared out;
  double energy = 0.0, energy_plain = 0.0;
  for (int k = 0; k < periods; ++k) {
    const VectorX command = wild_command(*model, k, share);
    plain->advance(command, 0.02, a);
    quick->advance(command, 0.02, b);
    if (a.diverged || !a.contacts.empty()) break;
    EXPECT_FALSE(b.diverged) << b.reason;
    EXPECT_EQ(a.contacts.size(), b.contacts.size());
    const PlantState &s = plain->state(), &t = quick->state();
    out.apart = std::max({out.apart, (s.q - t.q).lpNorm<Eigen::Infinity>(), (s.base - t.base).lpNorm<Eigen::Infinity>(),
                          (s.qdot - t.qdot).lpNorm<Eigen::Infinity>()});
    EXPECT_TRUE(s.q.allFinite() && t.q.allFinite());
    energy += b.energy;
    energy_plain += a.energy;
    out.redone += b.redone_steps;
    out.redone_by_plain += a.redone_steps;
    ++out.steps;
  }
  out.energy = std::abs(energy - energy_plain) / std::max(1.0, energy_plain);
  return out;
}

TEST(MotorBounds, WhereTheyDoNotBindTheStatesAreThoseOfThePlainSolve) {
  for (const char* name : kRobots) {
    const auto model = robot(name);
    for (const double step : {0.002, 0.01}) {
      const Compared gentle = compare(model, empty_world(*model), {}, step, 0.1, 150);
      EXPECT_GT(gentle.steps, 100) << name;
      EXPECT_LT(gentle.apart, 1e-9) << name << " at " << step;
      EXPECT_LT(gentle.energy, 1e-9) << name << " at " << step;
      EXPECT_EQ(gentle.redone_by_plain, 0);
    }
  }
}

TEST(MotorBounds, WhereTheyBindTheStepIsMadeAgainWithThem) {
  for (const char* name : kRobots) {
    RobotModel weak = *robot(name);
    for (ControlledJoint& joint : weak.joints) joint.effort *= 0.9;
    const auto model = std::make_shared<const RobotModel>(weak);
    PlantConditions heavy;
    heavy.payload.mass = 1.5;
    heavy.floor_friction = 0.5;
    heavy.joint_friction = VectorX::Constant(model->num_joints(), 0.3);
    for (const double step : {0.002, 0.01}) {
      const Compared wild = compare(model, empty_world(*model), heavy, step, 0.5, 150);
      EXPECT_GT(wild.steps, 30) << name;
      EXPECT_GT(wild.redone, 3) << name << " at " << step << ": nothing was at its limit";
      EXPECT_LT(wild.apart, 1e-9) << name << " at " << step << ", " << wild.redone << " redone";
      EXPECT_LT(wild.energy, 1e-9) << name << " at " << step;
      EXPECT_EQ(wild.redone_by_plain, 0);
    }
  }
}

TEST(PhysicsStep, NoStepMakesAStateThatIsNotFinite) {
  for (const char* name : kRobots) {
    const auto model = robot(name);
    for (const double step : {1e-4, 0.0007, 0.003, 0.007, 0.02}) {
      const auto plant = make_plant(model, empty_world(*model), with_step(step));
      PlantReport report;
      const int periods = step < 0.001 ? 25 : 150;
      for (int k = 0; k < periods; ++k) {
        plant->advance(wild_command(*model, k, 1.0), 0.02, report);
        const PlantState& s = plant->state();
        ASSERT_TRUE(s.q.allFinite() && s.qdot.allFinite() && s.base.allFinite()) << name << " at " << step;
        ASSERT_TRUE(std::isfinite(report.energy) && std::isfinite(report.slip_max)) << name << " at " << step;
        if (report.diverged || report.tipped || !report.contacts.empty()) break;
      }
    }
  }
}

/// Time and depth of the first contact of a base that drives into a wall, or is hit; -1 for none.
struct FirstContact {
  double time = -1.0, depth = 0.0;
};

FirstContact first_contact(const std::shared_ptr<const RobotModel>& model, const World& world, double speed,
                           double step, int periods) {
  const auto plant = make_plant(model, world, with_step(step));
  VectorX command = VectorX::Zero(model->num_velocities());
  command[0] = speed;
  PlantReport report;
  for (int k = 0; k < periods; ++k) {
    plant->advance(command, 0.02, report);
    if (report.contacts.empty()) continue;
    const auto first = std::min_element(report.contacts.begin(), report.contacts.end(),
                                        [](const Contact& a, const Contact& b) { return a.time < b.time; });
    return {first->time, first->depth};
  }
  return {};
}

TEST(PhysicsStep, ContactIsSeenWithinAMillisecondWhateverTheStep) {
  const auto model = robot("frankie");
  for (const ShapeKind kind : {ShapeKind::kBox, ShapeKind::kCylinder}) {  // by ODE, by the distance library
    World world = empty_world(*model);
    const Vector3 size = kind == ShapeKind::kBox ? Vector3(0.2, 2.0, 0.6) : Vector3(0.15, 0.8, 0.0);
    world.objects = {solid("thing", kind, size, {1.1, 0.0, 0.3})};
    const FirstContact fine = first_contact(model, world, 0.8, 0.0005, 200);
    ASSERT_GT(fine.time, 0.0);
    for (const double step : {0.001, 0.002, 0.005, 0.01, 0.02}) {
      const FirstContact found = first_contact(model, world, 0.8, step, 200);
      EXPECT_NEAR(found.time, fine.time, 1.6e-3) << "at " << step;
      EXPECT_GE(found.time, fine.time - 1e-3) << "at " << step;
    }
  }
}

TEST(PhysicsStep, WhatFliesThroughBetweenTwoStepsIsSeen) {
  // A ball of 6 cm that crosses the arm's place at 10 m/s: 20 cm a step of 20 ms.
  const auto model = robot("panda");
  World world = empty_world(*model);
  Kinematics kinematics(model);
  kinematics.update(Vector3::Zero(), world.start.q);
  const Vector3 hand = kinematics.X_WE().translation() + Vector3(0.0, 0.0, 0.05);
  for (const double y : {0.613, 0.731, 0.877}) {
    world.objects = {solid("ball", ShapeKind::kSphere, {0.03, 0, 0}, hand + Vector3(0.0, y, 0.0))};
    LinearMotion motion;
    motion.V_W[4] = -10.0;
    world.objects[0].motion = motion;
    for (const double step : {0.001, 0.01, 0.02}) {
      const auto plant = make_plant(model, world, with_step(step));
      PlantReport report;
      bool seen = false;
      int divided = 0;
      for (int k = 0; k < 8; ++k) {
        plant->advance(VectorX::Zero(7), 0.02, report);
        seen = seen || !report.contacts.empty();
        divided += report.divided_steps;
      }
      EXPECT_TRUE(seen) << "from " << y << " at " << step;
      if (step > 0.001) {
        EXPECT_GT(divided, 0);
      }
    }
  }
}

TEST(PhysicsStep, FarFromEverythingNoStepIsDivided) {
  const auto model = robot("frankie");
  World world = empty_world(*model);
  world.objects = {solid("ball", ShapeKind::kSphere, {0.1, 0, 0}, {3.0, 0.5, 0.5})};
  const auto plant = make_plant(model, world, SimulationConfig());
  PlantReport report;
  VectorX command = VectorX::Zero(model->num_velocities());
  command[0] = 0.5;
  int divided = 0;
  for (int k = 0; k < 100; ++k) {
    plant->advance(command, 0.02, report);
    divided += report.divided_steps;
  }
  EXPECT_EQ(divided, 0);
}

/// Robot shapes and objects at random, moving at random: whenever something touches on the way, the watch says so.
TEST(GapWatch, NothingTouchesOnAWayThatItCallsClear) {
  RobotModel model;
  Link base;
  base.name = "@base";
  model.links = {base};
  const auto shape = [](ShapeKind kind, const Vector3& size) {
    Shape s;
    s.kind = kind;
    s.size = size;
    return s;
  };
  const std::vector<Shape> kinds = {shape(ShapeKind::kSphere, {0.1, 0, 0}), shape(ShapeKind::kBox, {0.1, 0.3, 0.5}),
                                    shape(ShapeKind::kCapsule, {0.05, 0.4, 0}),
                                    shape(ShapeKind::kCylinder, {0.1, 0.3, 0})};
  for (const Shape& s : kinds) {
    CollisionShape robot_shape;
    robot_shape.shape = s;
    model.shapes.push_back(robot_shape);
  }
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j) model.self_pairs.push_back({i, j});
  World world;
  for (const Shape& s : kinds) {
    world.objects.emplace_back();
    world.objects.back().shape = s;
  }

  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto any = [&] { return Vector3(unit(random), unit(random), unit(random)); };
  struct Mover {
    Vector3 p, v, axis;
    double turn;
    Isometry at(double t) const {
      Isometry X = Isometry::Identity();
      X.translation() = p + t * v;
      X.linear() = Eigen::AngleAxisd(turn * t, axis).toRotationMatrix();
      return X;
    }
  };
  int clear_steps = 0, touching_steps = 0;
  for (int scene = 0; scene < 60; ++scene) {
    GapWatch watch(model, world, {true, true, true, true});
    std::vector<Mover> movers;
    for (int i = 0; i < 8; ++i)
      movers.push_back({any() + Vector3(0, 0, 1.3), any(), any().normalized(), 2.0 * unit(random)});
    const auto poses = [&](double t, SolidPoses& solids, std::vector<ObjectState>& objects) {
      solids.X_WS.clear();
      for (std::size_t i = 0; i < 4; ++i) solids.X_WS.push_back(movers[i].at(t));
      solids.X_WB = movers[0].at(t);
      objects.resize(4);
      for (std::size_t i = 0; i < 4; ++i) objects[i].X_WO = movers[4 + i].at(t);
    };
    const auto touches = [&](double t) {
      SolidPoses solids;
      std::vector<ObjectState> objects;
      poses(t, solids, objects);
      for (std::size_t i = 0; i < 4; ++i) {
        if (lowest_point(kinds[i], solids.X_WS[i]) < 0.0) return true;
        for (std::size_t j = 0; j < 4; ++j) {
          if (shape_distance(kinds[i], solids.X_WS[i], kinds[j], objects[j].X_WO).d < 0.0) return true;
          if (j > i && shape_distance(kinds[i], solids.X_WS[i], kinds[j], solids.X_WS[j]).d < 0.0) return true;
        }
      }
      return false;
    };
    SolidPoses solids;
    std::vector<ObjectState> objects;
    poses(0.0, solids, objects);
    watch.start(solids, objects);
    constexpr double kStep = 0.05;
    for (int k = 1; k <= 20; ++k) {
      poses(k * kStep, solids, objects);
      const bool clear = watch.moves_clear(solids, objects);
      bool touched = false;
      for (int i = 0; i <= 8 && !touched; ++i) touched = touches((k - 1 + i / 8.0) * kStep);
      EXPECT_FALSE(clear && touched) << "scene " << scene << ", step " << k;
      (touched ? touching_steps : clear_steps) += clear || touched;
      if (!clear) watch.start(solids, objects);
    }
  }
  EXPECT_GT(touching_steps, 100);
  EXPECT_GT(clear_steps, 300) << "a watch that is never sure is no help";
}

}  // namespace
}  // namespace moma
