// Control steps of moma on given states, for bench/peers: processor time, and how long single ones take.
//
//   moma_bench_control SUITE [STEPS]
//
// Drives the first controller of a suite through the suite's world 0, kinematic, and repeats its step on the states of
// that motion, over and over, STEPS in all. Prints one line of JSON: us of processor time a step (us), percentiles and
// the longest by the steady clock (p50, p999, worst) [us], the same of as many steps more by the thread's processor
// time, in which waiting for a turn does not count (cpu_p50, ...), processor time until the first step could be made
// (startup_s), steps.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "bench/suite_program.h"
#include "controller/controller.h"
#include "eval/suite/suite.h"
#include "eval/trial/trial.h"

namespace moma {
namespace {

double processor_seconds(clockid_t clock = CLOCK_PROCESS_CPUTIME_ID) {
  timespec now;
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Motion {
  std::vector<ObjectShape> objects;
  std::vector<Observation> states;
};

/// Keeps what it is shown.
class Watched final : public StepController {
 public:
  Watched(const TrialSpec& spec, Motion& motion)
      : controller_(spec.robot->model, spec.controller_params, spec.simulation.control_period), motion_(motion) {}
  void reset(std::span<const ObjectShape> objects) override {
    motion_.objects.assign(objects.begin(), objects.end());
    controller_.reset(objects);
  }
  void prepare(StepResult& result) const override { controller_.prepare(result); }
  void step(const Observation& observation, StepResult& result) noexcept override {
    motion_.states.push_back(observation);
    controller_.step(observation, result);
  }

 private:
  Controller controller_;
  Motion& motion_;
};

double percentile(std::vector<float>& values, double part) {
  const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return static_cast<double>(values[static_cast<std::size_t>(at)]);
}

std::string percentiles(std::vector<float>& us, const std::string& clock) {
  return fmt::format(R"("{0}p50":{1:.3f},"{0}p999":{2:.3f},"{0}worst":{3:.3f})", clock, percentile(us, 0.5),
                     percentile(us, 0.999), percentile(us, 1.0));
}

void run(const std::string& file, std::uint64_t steps) {
  const Suite suite = load_suite(file);
  SuitePoint point = suite.points.at(0);
  Motion motion;
  TrialParts parts;
  parts.controller = [&motion](const TrialSpec& spec) { return std::make_unique<Watched>(spec, motion); };
  point.simulation.mode = SimulationMode::kKinematic;
  const World world = point.worlds.make(point.robot->model, 0);
  const double ready = processor_seconds();
  run_trial(point, world, parts);

  Controller controller(point.robot->model, point.controller_params, point.simulation.control_period);
  controller.reset(motion.objects);
  StepResult result;
  controller.prepare(result);
  std::vector<float> us(steps);
  using Clock = std::chrono::steady_clock;
  const double begin = processor_seconds();
  Clock::time_point before = Clock::now();
  for (std::size_t i = 0; i < steps; ++i) {
    controller.step(motion.states[i % motion.states.size()], result);
    const Clock::time_point now = Clock::now();
    us[i] = std::chrono::duration<float, std::micro>(now - before).count();
    before = now;
  }
  const double each = 1e6 * (processor_seconds() - begin) / static_cast<double>(steps);
  const std::string by_clock = percentiles(us, "");
  double last = processor_seconds(CLOCK_THREAD_CPUTIME_ID);
  for (std::size_t i = 0; i < steps; ++i) {
    controller.step(motion.states[i % motion.states.size()], result);
    const double now = processor_seconds(CLOCK_THREAD_CPUTIME_ID);
    us[i] = static_cast<float>(1e6 * (now - last));
    last = now;
  }
  fmt::print(R"({{"us":{:.4f},{},{},"startup_s":{:.4f},"steps":{},"states":{}}})"
             "\n",
             each, by_clock, percentiles(us, "cpu_"), ready, steps, motion.states.size());
}

}  // namespace
}  // namespace moma

int main(int argc, char** argv) { return moma::suite_program(argc, argv, "STEPS", moma::run); }
