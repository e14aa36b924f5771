#include "eval/trial/trial.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <new>

#include "controller/controller.h"
#include "eval/trial/loop.h"
#include "world/sensing/sensing.h"

namespace moma {
namespace {

TrialRow row_of_error(const TrialSpec& spec, const Recording& recording, const char* text) {
  TrialRow row;
  try {
    row = measure(recording, *spec.robot->model);
  } catch (const std::exception&) {
    row = {};
  }
  row.outcome = Outcome::kError;
  row.reason = text;
  row.time_end_s = static_cast<double>(recording.trace.size()) * spec.simulation.control_period;
  return row;
}

}  // namespace

ControllerParams told_params(const TrialSpec& spec) {
  ControllerParams params = spec.controller_params;
  params.escape.position = std::min(params.escape.position, spec.success.position);
  params.escape.orientation = std::min(params.escape.orientation, spec.success.orientation);
  return params;
}

std::unique_ptr<StepController> usual_controller(const TrialSpec& spec, StepClock* clock) {
  if (spec.plugin != nullptr) return spec.plugin->make();
  auto controller = std::make_unique<Controller>(spec.robot->model, told_params(spec), spec.simulation.control_period);
  controller->enable_timing(true);
  controller->set_clock(clock);
  return controller;
}

std::unique_ptr<Plant> usual_plant(const TrialSpec& spec, const World& world) {
  const std::shared_ptr<const RobotModel>& model = spec.robot->model;
  return make_plant(model, world, spec.simulation, plant_conditions(spec.disturbances, *model, world));
}

std::optional<TrialRow> error_of(const TrialSpec& spec, const Recording& recording, const std::function<void()>& part) {
  try {
    part();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    return row_of_error(spec, recording, e.what());
  } catch (...) {
    return row_of_error(spec, recording, "an exception of unknown type");
  }
  return {};
}

TrialOutput run_trial(const TrialSpec& spec, const World& world, const TrialParts& parts, ProfileClock* clock) {
  const auto start = std::chrono::steady_clock::now();
  Recording recording;
  TrialOutput output;
  enter(clock, TrialPart::kSetUp);
  const std::optional<TrialRow> error = error_of(spec, recording, [&] {
    const std::unique_ptr<Plant> plant = parts.plant ? parts.plant(spec, world) : usual_plant(spec, world);
    plant->set_clock(clock);
    const std::unique_ptr<StepController> controller =
        parts.controller ? parts.controller(spec) : usual_controller(spec, clock);
    output.row = run_loop(spec, world, *plant, *controller, recording, clock);
  });
  if (error) output.row = *error;
  output.trace = std::move(recording.trace);
  output.row.timing.t_trial_us =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  return output;
}

void check_plant(const TrialSpec& spec) {
  World world;
  world.robot = spec.robot->model->name;
  world.start.q = spec.robot->model->ready;
  (void)usual_plant(spec, world);
}

}  // namespace moma
