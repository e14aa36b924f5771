#pragma once

// Robots of configs/robots among balls, boxes and cylinders that leave start and goal free, judged by coal alone.

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "controller/controller.h"
#include "controller/plan/planner.h"
#include "tests/support/coal_distance.h"
#include "tests/support/robots.h"
#include "tests/support/shapes.h"

namespace moma::test {

/// As configs/controllers/moma-reactive.yaml where it matters for paths.
inline ControllerParams plan_params(const RobotModel& model) {
  ControllerParams params;
  params.acceleration_limit = VectorX::Constant(model.num_velocities(), 5.0);
  params.plan.enabled = true;
  return resolved(params, model);
}

struct Scene {
  std::vector<ObjectShape> shapes;
  std::vector<ObjectState> states;
  WholeConfiguration start;
  Isometry X_WG = Isometry::Identity();
};

inline double uniform_in(std::mt19937_64& engine, double low, double high) {
  return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1.0p-53;
}

/// Least distance of a configuration from objects, by coal's own entry point. Shapes of robots without hulls.
inline double object_clearance(const RobotModel& model, const Kinematics& kinematics, const Scene& scene) {
  double least = 1e9;
  for (const CollisionShape& shape : model.shapes) {
    const Isometry X_WS = kinematics.X_WS(shape);
    for (std::size_t j = 0; j < scene.shapes.size(); ++j) {
      const double reach = bounding_radius(shape.shape) + bounding_radius(scene.shapes[j].shape);
      const double apart = (X_WS.translation() - scene.states[j].X_WO.translation()).norm() - reach;
      if (apart > 0.3) continue;
      least = std::min(least, coal_distance(shape.shape, X_WS, scene.shapes[j].shape, scene.states[j].X_WO));
    }
  }
  return least;
}

/// Least distance from floor and from itself, over the pairs that have rows.
inline double own_clearance(const RobotModel& model, const Kinematics& kinematics) {
  double least = 1e9;
  for (const CollisionShape& shape : model.shapes)
    if (!shape.rigid_with_base)
      least = std::min(least, -support(shape.shape, kinematics.X_WS(shape), -Vector3::UnitZ()));
  for (const SelfPair& pair : model.self_pairs) {
    if (!pair.row) continue;
    const CollisionShape& a = model.shapes[static_cast<std::size_t>(pair.first)];
    const CollisionShape& b = model.shapes[static_cast<std::size_t>(pair.second)];
    least = std::min(least, coal_distance(a.shape, kinematics.X_WS(a), b.shape, kinematics.X_WS(b)));
  }
  return least;
}

/// The robot at the origin with its arm at `ready`, a goal that some free configuration reaches, and `count` objects
/// that stay 0.12 m away from both.
inline Scene make_scene(const std::shared_ptr<const RobotModel>& model, std::uint64_t seed, int count) {
  std::mt19937_64 engine(seed);
  Scene scene;
  const int joints = model->num_joints();
  scene.start = WholeConfiguration::Zero(3 + joints);
  scene.start.tail(joints) = model->ready;
  Kinematics start(model), goal(model);
  start.update(scene.start.head<3>(), scene.start.tail(joints));
  const bool mobile = model->mobile();
  VectorX q(joints);
  Vector3 base = Vector3::Zero();
  do {
    for (int i = 0; i < joints; ++i) {
      const ControlledJoint& joint = model->joints[static_cast<std::size_t>(i)];
      const double low = std::isfinite(joint.lower) ? joint.lower : -3.0;
      const double high = std::isfinite(joint.upper) ? joint.upper : 3.0;
      q[i] = uniform_in(engine, low + 0.2 * (high - low), high - 0.2 * (high - low));
    }
    if (mobile) base = {uniform_in(engine, 1.5, 3.5), uniform_in(engine, -1.5, 1.5), uniform_in(engine, -3.0, 3.0)};
    goal.update(base, q);
  } while (own_clearance(*model, goal) < 0.005 || goal.X_WE().translation().z() < 0.1);
  scene.X_WG = goal.X_WE();
  while (static_cast<int>(scene.shapes.size()) < count) {
    Shape shape = make_sphere(uniform_in(engine, 0.08, 0.25));
    if (engine() % 3 == 0)
      shape = make_box(uniform_in(engine, 0.1, 0.5), uniform_in(engine, 0.1, 0.5), uniform_in(engine, 0.2, 1.2));
    if (engine() % 3 == 0) shape = make_cylinder(uniform_in(engine, 0.05, 0.2), uniform_in(engine, 0.3, 1.5));
    ObjectState state;
    state.X_WO.translation() =
        mobile ? Vector3(uniform_in(engine, -1.0, 4.5), uniform_in(engine, -2.5, 2.5), uniform_in(engine, 0.1, 1.0))
               : Vector3(uniform_in(engine, -0.9, 0.9), uniform_in(engine, -0.9, 0.9), uniform_in(engine, 0.1, 1.2));
    Scene one = scene;
    one.shapes = {{"one", shape}};
    one.states = {state};
    if (object_clearance(*model, start, one) < 0.12 || object_clearance(*model, goal, one) < 0.12) continue;
    scene.shapes.push_back({"o" + std::to_string(scene.shapes.size()), shape});
    scene.states.push_back(state);
  }
  return scene;
}

/// A wall between the robot and its goal, with a way round it.
inline Scene behind_a_wall(const std::shared_ptr<const RobotModel>& model, std::uint64_t seed) {
  Scene scene = make_scene(model, seed, 0);
  scene.X_WG.translation() << 2.6, 0.2, 0.6;
  scene.shapes = {{"wall", make_box(0.2, 2.4, 1.6)}};
  scene.states.resize(1);
  scene.states[0].X_WO.translation() << 1.4, 0.0, 0.8;
  return scene;
}

/// A low wall across the way with a gap that leaves a Frankie's base `margin` on either side.
inline Scene before_a_gap(const std::shared_ptr<const RobotModel>& model, std::uint64_t seed, double margin) {
  Scene scene = behind_a_wall(model, seed);
  constexpr double kHalf = 3.0, kWide = 1.0;  // of each part, and of the gap until it is measured
  scene.shapes = {{"left", make_box(0.2, 2.0 * kHalf, 0.3)}, {"right", make_box(0.2, 2.0 * kHalf, 0.3)}};
  scene.states.resize(2);
  const auto set = [&](double gap) {
    scene.states[0].X_WO.translation() << 1.4, kHalf + 0.5 * gap, 0.15;
    scene.states[1].X_WO.translation() << 1.4, -kHalf - 0.5 * gap, 0.15;
  };
  set(kWide);
  Kinematics inside(model);
  inside.update(Vector3(1.4, 0.0, 0.0), model->ready);
  set(kWide - 2.0 * (object_clearance(*model, inside, scene) - margin));
  return scene;
}

/// Plans to the end, after what was planned before; true if there is a way.
inline bool plan_again(Planner& planner, const Scene& scene, std::uint64_t seed) {
  planner.begin(scene.start, scene.X_WG, scene.states, seed);
  long budget = 1L << 40;
  planner.advance(budget);
  return planner.found();
}

/// A whole plan at once.
inline bool plan_whole(Planner& planner, const Scene& scene, std::uint64_t seed) {
  planner.set_objects(scene.shapes);
  return plan_again(planner, scene, seed);
}

inline std::vector<std::string> plan_robots() {
  return {"configs/robots/frankie.yaml", "configs/robots/frankie_omni.yaml", "configs/robots/panda.yaml",
          "configs/robots/lift_ur5.yaml"};
}

}  // namespace moma::test
