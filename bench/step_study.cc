// Compares outcomes and cost of physics steps: each trial of a suite runs at several steps.
//
//   moma_bench_step_study SUITE [WORLDS]
//
// For each controller and step: successes and collisions, trials whose outcome is another one than at 2 ms, the deepest
// contact, steps divided near contact and made again at a motor's limit, and the processor time of a simulated second.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <string>

#include "bench/suite_program.h"
#include "eval/suite/suite.h"
#include "eval/trial/trial.h"

namespace moma {
namespace {

constexpr std::array kSteps = {0.001, 0.002, 0.004, 0.005, 0.01, 0.02};
constexpr std::size_t kReference = 1;

struct Tally {
  int trials = 0, successes = 0, collisions = 0, others = 0;
  double divided = 0.0, redone = 0.0;
  double deepest = 0.0, simulated = 0.0, spent = 0.0;
};

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void count(const TrialRow& row, double spent, Tally& tally) {
  ++tally.trials;
  tally.successes += row.outcome == Outcome::kSuccess ? 1 : 0;
  tally.collisions += row.outcome == Outcome::kCollision ? 1 : 0;
  tally.divided += row.divided_steps;
  tally.redone += row.redone_steps;
  if (row.outcome == Outcome::kCollision) tally.deepest = std::max(tally.deepest, row.collision_depth_m);
  tally.simulated += row.time_end_s;
  tally.spent += spent;
}

void run(const std::string& file, std::uint64_t worlds) {
  const Suite suite = load_suite(file);
  std::map<std::string, std::array<Tally, kSteps.size()>> table;
  for (const SuitePoint& point : suite.points) {
    const std::string name = point.controller + (point.label.empty() ? "" : " " + point.label);
    for (std::uint64_t i = 0; i < worlds; ++i) {
      const World world = point.worlds.make(point.robot->model, i);
      std::array<TrialRow, kSteps.size()> rows;
      for (std::size_t k = 0; k < kSteps.size(); ++k) {
        SuitePoint trial = point;
        trial.simulation.physics_step = kSteps[k];
        const double before = processor_seconds();
        rows[k] = run_trial(trial, world).row;
        count(rows[k], processor_seconds() - before, table[name][k]);
      }
      for (std::size_t k = 0; k < kSteps.size(); ++k) {
        if (rows[k].outcome == rows[kReference].outcome) continue;
        ++table[name][k].others;
        fmt::print("{} in {} world {}: {} at {} ms, {} at {} ms\n", name, world.family, i, to_string(rows[k].outcome),
                   1e3 * kSteps[k], to_string(rows[kReference].outcome), 1e3 * kSteps[kReference]);
        std::fflush(stdout);
      }
    }
  }
  for (const auto& [name, steps] : table) {
    fmt::print(
        "\n| {}, {} trials | success | collision | another outcome than at 2 ms | deepest contact mm | "
        "divided steps | redone steps | ms/s |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n",
        name, steps[0].trials);
    for (std::size_t k = 0; k < kSteps.size(); ++k) {
      const Tally& t = steps[k];
      fmt::print("| {} ms | {} | {} | {} | {:.2g} | {} | {} | {:.1f} |\n", 1e3 * kSteps[k], t.successes, t.collisions,
                 t.others, 1e3 * t.deepest, t.divided, t.redone, 1e3 * t.spent / t.simulated);
    }
  }
}

}  // namespace
}  // namespace moma

int main(int argc, char** argv) { return moma::suite_program(argc, argv, "WORLDS", moma::run); }
