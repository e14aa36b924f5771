#include "eval/trial/trial.h"

#include <chrono>
#include <exception>

#include "controller/controller.h"
#include "eval/trial/clock.h"
#include "world/sensing/conditions.h"

namespace moma {
namespace {

std::unique_ptr<StepController> usual_controller(const Point& point) {
  if (point.plugin != nullptr) return point.plugin->make();
  auto controller =
      std::make_unique<Controller>(point.robot->model, point.controller_params, point.simulation.control_period);
  controller->enable_timing(true);
  return controller;
}

std::unique_ptr<Plant> usual_plant(const Point& point, const World& world) {
  const std::shared_ptr<const RobotModel>& model = point.robot->model;
  return make_plant(model, world, point.simulation, plant_conditions(point.disturbances, *model, world));
}

}  // namespace

TrialOutput run_trial(const Point& point, const World& world, const TrialParts& parts) {
  const auto start = std::chrono::steady_clock::now();
  Recording recording;
  TrialOutput output;
  const auto failed = [&](const char* text) {
    // What was measured until the exception is kept.
    try {
      output.row = measure(recording, *point.robot->model);
    } catch (const std::exception&) {
      output.row = {};
    }
    output.row.outcome = Outcome::kError;
    output.row.reason = text;
    output.row.time_end_s = static_cast<double>(recording.trace.size()) * point.simulation.control_period;
  };
  try {
    const std::unique_ptr<Plant> plant = parts.plant ? parts.plant(point, world) : usual_plant(point, world);
    const std::unique_ptr<StepController> controller =
        parts.controller ? parts.controller(point) : usual_controller(point);
    output.row = run_clock(point, world, *plant, *controller, recording);
  } catch (const std::exception& e) {
    failed(e.what());
  } catch (...) {
    failed("an exception of unknown type");
  }
  output.trace = std::move(recording.trace);
  output.row.timing.t_trial_us =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  return output;
}

}  // namespace moma
