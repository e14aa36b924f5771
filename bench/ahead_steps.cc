// Measures the cost of looking ahead in a step, and shows the robot's motion meanwhile.
//
//   moma_bench_ahead SUITE [TRIALS]
//
// Runs the first worlds of a suite with each of its controllers of moma's. What each controller observed in a world is
// then gone through again, kRounds times in turn with the others, and of each step the least time is kept: what else
// the machine does is nearly out of it. Of each: percentiles of the processor time of a step, its median beside that
// of the first controller, and how the time of the trials is spent, by mode.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
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

/// Processor time of this thread: other work on the machine is no part of it.
double processor_seconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

constexpr int kRounds = 5;

// Observations and answers of a controller in one trial.
struct Recording {
  std::vector<ObjectShape> objects;
  std::vector<Observation> observations;
  std::vector<VectorX> commands;
};

struct Record {
  std::vector<double> step_seconds;
  std::array<std::size_t, kModes> steps{};
  std::vector<double> time_to_goal;
  int trials = 0, choices = 0, different = 0;
};

class Watched final : public StepController {
 public:
  Watched(const TrialSpec& point, Record& record, Recording& recording)
      : controller_(point.robot->model, point.controller_params, point.simulation.control_period),
        record_(record),
        recording_(recording) {}

  void reset(std::span<const ObjectShape> objects) override {
    recording_.objects.assign(objects.begin(), objects.end());
    controller_.reset(objects);
  }
  void prepare(StepResult& result) const override { controller_.prepare(result); }
  void step(const Observation& observation, StepResult& result) noexcept override {
    controller_.step(observation, result);
    recording_.observations.push_back(observation);
    recording_.commands.push_back(result.command);
    ++record_.steps[static_cast<std::size_t>(result.plan.mode)];
    if (result.plan.attempts > attempts_) ++record_.choices;
    attempts_ = result.plan.attempts;
  }

 private:
  Controller controller_;
  Record& record_;
  Recording& recording_;
  int attempts_ = 0;
};

double percentile(std::vector<double>& values, double part) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

Recording run_one(const SuitePoint& point, const World& world, Record& record) {
  Recording recording;
  TrialParts parts;
  parts.controller = [&](const TrialSpec& spec) { return std::make_unique<Watched>(spec, record, recording); };
  const TrialRow row = run_trial(point, world, parts).row;
  ++record.trials;
  if (row.outcome == Outcome::kSuccess) record.time_to_goal.push_back(row.time_to_goal_s);
  return recording;
}

// The same steps again; `least` becomes the least time of each so far. Returns how many were not the same.
int go_through(const Recording& recording, Controller& controller, std::vector<double>& least) {
  controller.reset(recording.objects);
  StepResult result;
  controller.prepare(result);
  int different = 0;
  for (std::size_t i = 0; i < recording.observations.size(); ++i) {
    const double before = processor_seconds();
    controller.step(recording.observations[i], result);
    least[i] = std::min(least[i], processor_seconds() - before);
    if (result.command != recording.commands[i]) ++different;
  }
  return different;
}

// `first`: the median of the first controller [s], 0 for that one itself.
double print(const std::string& name, Record& r, double first) {
  const double steps = static_cast<double>(std::max<std::size_t>(1, r.step_seconds.size()));
  fmt::print("{}: {} of {} reach the goal, median {:.2f} s; {:.2f} choices a trial\n", name, r.time_to_goal.size(),
             r.trials, percentile(r.time_to_goal, 0.5), static_cast<double>(r.choices) / std::max(1, r.trials));
  const double median = percentile(r.step_seconds, 0.5);
  fmt::print("  step [us] of {}: median {:.1f}, mean {:.1f}, p99 {:.1f}, p99.9 {:.1f}, most {:.1f}",
             r.step_seconds.size(), 1e6 * median,
             1e6 * std::accumulate(r.step_seconds.begin(), r.step_seconds.end(), 0.0) / steps,
             1e6 * percentile(r.step_seconds, 0.99), 1e6 * percentile(r.step_seconds, 0.999),
             1e6 * percentile(r.step_seconds, 1.0));
  if (first > 0.0) fmt::print("; median {:.2f} times that of the first", median / first);
  if (r.different > 0) fmt::print("; {} STEPS CAME OUT OTHERWISE WHEN REPEATED", r.different);
  fmt::print("\n");
  fmt::print("  time in");
  for (std::size_t m = 0; m < kModes; ++m)
    fmt::print(" {} {:.1f} %{}", words(Of<PlanMode>{})[m], 100.0 * static_cast<double>(r.steps[m]) / steps,
               m + 1 < kModes ? "," : "\n");
  return median;
}

void run(const std::string& file, std::uint64_t trials) {
  const Suite suite = load_suite(file);
  const std::size_t points = suite.points.size();
  std::vector<Record> records(points);
  std::vector<Controller> controllers;
  for (const SuitePoint& point : suite.points)
    controllers.emplace_back(point.robot->model, point.controller_params, point.simulation.control_period);
  for (std::uint64_t i = 0; i < trials; ++i) {
    std::vector<Recording> recordings;
    std::vector<std::vector<double>> least;
    for (std::size_t k = 0; k < points; ++k) {
      const SuitePoint& point = suite.points[k];
      recordings.push_back(run_one(point, point.worlds.make(point.robot->model, i), records[k]));
      least.emplace_back(recordings[k].observations.size(), std::numeric_limits<double>::infinity());
    }
    for (int round = 0; round < kRounds; ++round)
      for (std::size_t k = 0; k < points; ++k)
        records[k].different += go_through(recordings[k], controllers[k], least[k]);
    for (std::size_t k = 0; k < points; ++k)
      records[k].step_seconds.insert(records[k].step_seconds.end(), least[k].begin(), least[k].end());
  }
  double first = 0.0;
  for (std::size_t k = 0; k < points; ++k) {
    const double median = print(suite.points[k].controller, records[k], first);
    if (k == 0) first = median;
  }
}

}  // namespace
}  // namespace moma

int main(int argc, char** argv) { return moma::suite_program(argc, argv, "TRIALS", moma::run); }
