#pragma once

#include <string>

#include "eval/trial/trial.h"
#include "tests/support/fake_plant.h"
#include "tests/support/tiny_robot.h"

namespace moma::test {

/// The tiny robot: kinematic, 0.02 s, 10 s.
inline TrialSpec tiny_spec() {
  TrialSpec spec;
  spec.robot = tiny_loaded_robot();
  spec.simulation.mode = SimulationMode::kKinematic;
  spec.simulation.time_limit = 10.0;
  return spec;
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
inline TrialOutput run_scripted(const TrialSpec& spec, const World& world, ScriptedController::Script script,
                                FakePlant::Fault fault = {}) {
  TrialParts parts;
  parts.plant = [fault](const TrialSpec& p, const World& w) {
    return std::make_unique<FakePlant>(p.robot->model, w, fault);
  };
  parts.controller = [script](const TrialSpec& p) {
    return std::make_unique<ScriptedController>(p.robot->model->num_velocities(), script);
  };
  return run_trial(spec, world, parts);
}

/// Drives straight at `speed` until `stop_at` seconds.
inline ScriptedController::Script drive(double speed, double stop_at) {
  return [=](const Observation& observation, StepResult& result) {
    if (observation.time < stop_at - 1e-9) result.command[0] = speed;
  };
}

}  // namespace moma::test
