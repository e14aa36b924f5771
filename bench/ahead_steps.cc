// What looking ahead costs in a step, and what the robot does meanwhile.
//
//   moma_bench_ahead SUITE [TRIALS]
//
// Runs the first worlds of a suite with each of its controllers of moma's, one after another. Of each: percentiles of
// the processor time of a step, and how the time of the trials is spent, by mode.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "bench/suite_program.h"
#include "controller/controller.h"
#include "eval/suite/suite.h"
#include "eval/trial/trial.h"

namespace moma {
namespace {

constexpr std::size_t kModes = words(Of<PlanMode>{}).size();

/// Of this thread: what others do on the machine is not in it.
double processor_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Record {
  std::vector<double> step_seconds;
  std::array<std::size_t, kModes> steps{};
  std::vector<double> time_to_goal;
  int trials = 0, choices = 0;
};

class Watched final : public StepController {
 public:
  Watched(const TrialSpec& point, Record& record)
      : controller_(point.robot->model, point.controller_params, point.simulation.control_period), record_(record) {}

  void reset(std::span<const ObjectShape> objects) override { controller_.reset(objects); }
  void prepare(StepResult& result) const override { controller_.prepare(result); }
  void step(const Observation& observation, StepResult& result) noexcept override {
    const double before = processor_seconds();
    controller_.step(observation, result);
    record_.step_seconds.push_back(processor_seconds() - before);
    ++record_.steps[static_cast<std::size_t>(result.plan.mode)];
    if (result.plan.attempts > attempts_) ++record_.choices;
    attempts_ = result.plan.attempts;
  }

 private:
  Controller controller_;
  Record& record_;
  int attempts_ = 0;
};

double percentile(std::vector<double>& values, double part) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

Record watch(const SuitePoint& point, std::uint64_t trials) {
  Record record;
  TrialParts parts;
  parts.controller = [&record](const TrialSpec& spec) { return std::make_unique<Watched>(spec, record); };
  for (std::uint64_t i = 0; i < trials; ++i) {
    const World world = point.worlds.make(point.robot->model, i);
    const TrialRow row = run_trial(point, world, parts).row;
    ++record.trials;
    if (row.outcome == Outcome::kSuccess) record.time_to_goal.push_back(row.time_to_goal_s);
  }
  return record;
}

void print(const std::string& name, Record& r) {
  const double steps = static_cast<double>(std::max<std::size_t>(1, r.step_seconds.size()));
  fmt::print("{}: {} of {} reach the goal, median {:.2f} s; {:.2f} choices a trial\n", name, r.time_to_goal.size(),
             r.trials, percentile(r.time_to_goal, 0.5), static_cast<double>(r.choices) / std::max(1, r.trials));
  fmt::print("  step [us] of {}: median {:.1f}, mean {:.1f}, p99 {:.1f}, p99.9 {:.1f}, most {:.1f}\n",
             r.step_seconds.size(), 1e6 * percentile(r.step_seconds, 0.5),
             1e6 * std::accumulate(r.step_seconds.begin(), r.step_seconds.end(), 0.0) / steps,
             1e6 * percentile(r.step_seconds, 0.99), 1e6 * percentile(r.step_seconds, 0.999),
             1e6 * percentile(r.step_seconds, 1.0));
  fmt::print("  time in");
  for (std::size_t m = 0; m < kModes; ++m)
    fmt::print(" {} {:.1f} %{}", words(Of<PlanMode>{})[m], 100.0 * static_cast<double>(r.steps[m]) / steps,
               m + 1 < kModes ? "," : "\n");
}

void run(const std::string& file, std::uint64_t trials) {
  const Suite suite = load_suite(file);
  for (const SuitePoint& point : suite.points) {
    Record record = watch(point, trials);
    print(point.controller, record);
  }
}

}  // namespace
}  // namespace moma

int main(int argc, char** argv) { return moma::suite_program(argc, argv, "TRIALS", moma::run); }
