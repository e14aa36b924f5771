#pragma once

#include <string>

#include "eval/trial/trial.h"
#include "tests/support/fake_plant.h"
#include "tests/support/tiny_robot.h"

namespace moma::test {

/// A point of the tiny robot: kinematic, 0.02 s, 10 s.
inline Point tiny_point() {
  Point point;
  point.controller = "scripted";
  point.params = nlohmann::ordered_json::object();
  point.robot = tiny_loaded_robot();
  point.simulation.mode = SimulationMode::kKinematic;
  point.simulation.time_limit = 10.0;
  return point;
}

/// Robot at the origin, goal `ahead` metres in front of the tip at rest, in the tip's own orientation.
inline World tiny_world(double ahead) {
  World world;
  world.family = "test";
  world.robot = "tiny";
  world.start.q = VectorX::Zero(3);
  world.goal.X_WG.translation() = Vector3(0.9 + ahead, 0.0, 0.5);
  return world;
}

inline WorldObject sphere(const std::string& name, const Vector3& position, double radius) {
  WorldObject object;
  object.name = name;
  object.shape.kind = ShapeKind::kSphere;
  object.shape.size = Vector3(radius, 0, 0);
  object.X_WO.translation() = position;
  return object;
}

/// Runs a scripted controller on the exact plant.
inline TrialOutput run_scripted(const Point& point, const World& world, ScriptedController::Script script,
                                FakePlant::Fault fault = {}) {
  TrialParts parts;
  parts.plant = [fault](const Point& p, const World& w) {
    return std::make_unique<FakePlant>(p.robot->model, w, fault);
  };
  parts.controller = [script](const Point& p) {
    return std::make_unique<ScriptedController>(p.robot->model->num_velocities(), script);
  };
  return run_trial(point, world, parts);
}

/// Drives straight at `speed` until `stop_at` seconds.
inline ScriptedController::Script drive(double speed, double stop_at) {
  return [=](const Observation& observation, StepResult& result) {
    if (observation.time < stop_at - 1e-9) result.command[0] = speed;
  };
}

}  // namespace moma::test
