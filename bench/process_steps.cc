// Measures the cost of a process for a controller's step beyond the controller's own time: a class of Python, or a
// program, that does nothing. Run as `build/moma_bench_process SUITE [STEPS]` with a suite whose controllers do
// nothing, for instance examples/process/hold.yaml.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/suite_program.h"
#include "controller/step.h"
#include "eval/suite/suite.h"

namespace moma {
namespace {

// Median and 99th percentile of a step [us], among so many objects.
void measure(const SuitePoint& point, std::size_t objects, std::uint64_t steps) {
  const auto controller = point.plugin->make();
  controller->reset(std::vector<ObjectShape>(objects, {"ball", {ShapeKind::kSphere, {0.1, 0.0, 0.0}, nullptr}}));
  StepResult result;
  controller->prepare(result);
  const RobotModel& model = *point.robot->model;
  Observation seen;
  seen.q = model.ready;
  seen.qdot = VectorX::Zero(model.num_velocities());
  seen.objects.resize(objects);
  std::vector<double> times;
  for (std::uint64_t k = 0; k < steps; ++k) {
    seen.time = static_cast<double>(k) * point.simulation.control_period;
    const auto before = std::chrono::steady_clock::now();
    controller->step(seen, result);
    times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - before).count());
  }
  if (!controller->failure().empty()) throw std::runtime_error(std::string(controller->failure()));
  std::sort(times.begin(), times.end());
  fmt::print("{:24} {:3} objects: median {:6.1f} us, 99 % {:6.1f} us\n", point.controller, objects,
             times[times.size() / 2], times[times.size() * 99 / 100]);
}

void run(const std::string& suite, std::uint64_t steps) {
  for (const SuitePoint& point : load_suite(suite).points)
    if (point.plugin != nullptr)
      for (const std::size_t objects : {0, 20}) measure(point, objects, std::max<std::uint64_t>(steps, 100));
}

}  // namespace
}  // namespace moma

int main(int argc, char** argv) { return moma::suite_program(argc, argv, "STEPS", moma::run); }
