// Plans from start to goal, without a robot that moves. What moves is left out, and a goal in motion is taken where it
// begins.
//
//   moma_bench_plans SUITE [WORLDS]
//
// For each sweep point of a suite, whatever its controllers: in how many of its first worlds a planner with much work
// at its hands finds a path of base and arm that keeps the clearance of a tight path. Of a world without one it is
// unknown whether there is any. For each controller that looks ahead: what its own planner needs in these worlds, by
// family, where it begins again after each failure as the controller does.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "bench/suite_program.h"
#include "controller/plan/planner.h"
#include "eval/suite/suite.h"

namespace moma {
namespace {

/// Plans as the preset that looks ahead does, with far more checks.
ControllerParams patient(const TrialSpec& point) {
  ControllerParams params = resolved(point.controller_params, *point.robot->model);
  params.plan.enabled = true;
  params.plan.roomy = params.plan.clearance = 0.02;
  params.plan.ik_tries = 3000;
  params.plan.checks = 400000;
  params.plan.runs = 1;
  params.plan.shortcuts = 0;
  return params;
}

WholeConfiguration start_of(const World& world) {
  WholeConfiguration start(3 + world.start.q.size());
  start << world.start.base, world.start.q;
  return start;
}

/// The number of the plan that is found, from 1; 0 where none of `most` is. Calls `each` after every plan.
template <class Each>
int plan(Planner& planner, const World& world, int most, Each&& each) {
  planner.set_objects(object_shapes(world));
  std::vector<ObjectState> states(world.objects.size());
  object_states(world, 0.0, states);
  for (int k = 1; k <= most; ++k) {
    planner.begin(start_of(world), world.goal.X_WG, states, static_cast<std::uint64_t>(k - 1));
    long budget = 1L << 40;
    planner.advance(budget);
    each();
    if (planner.found()) return k;
  }
  return 0;
}

/// Results of plans.
struct Tally {
  int worlds = 0, found = 0, first = 0;
  std::vector<double> checks, seconds, times;  // of those that were found; checks of all plans until then

  void print(const std::string& name) {
    const auto at = [](std::vector<double>& values, double part) {
      if (values.empty()) return 0.0;
      const auto k = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1) + 0.5);
      std::nth_element(values.begin(), values.begin() + k, values.end());
      return values[static_cast<std::size_t>(k)];
    };
    fmt::print("{:24} {:6} {:6} {:6} {:10.0f} {:10.0f} {:10.1f} {:8.2f}\n", name, worlds, found, first, at(checks, 0.5),
               at(checks, 0.9), 1e3 * at(seconds, 0.5), at(times, 0.5));
  }
};

void print_plans(const SuitePoint& point, std::uint64_t count) {
  constexpr int kMost = 10;
  Planner planner(point.robot->model, resolved(point.controller_params, *point.robot->model));
  std::map<std::string, Tally> families;
  Tally all;
  for (std::uint64_t i = 0; i < count; ++i) {
    const World world = point.worlds.make(point.robot->model, i);
    const auto begin = std::chrono::steady_clock::now();
    double checks = 0.0;
    const int plans = plan(planner, world, kMost, [&] { checks += static_cast<double>(planner.counts().checks); });
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (Tally* tally : {&all, &families[world.family]}) {
      ++tally->worlds;
      if (plans == 0) continue;
      ++tally->found;
      tally->first += plans == 1 ? 1 : 0;
      tally->checks.push_back(checks);
      tally->seconds.push_back(seconds);
      tally->times.push_back(planner.path().duration);
    }
  }
  fmt::print("\n{} {}: found in {} plans, in the first one; checks until then; CPU time; duration of the path\n",
             point.controller, point.label, kMost);
  fmt::print("{:24} {:>6} {:>6} {:>6} {:>10} {:>10} {:>10} {:>8}\n", "family", "worlds", "found", "first", "median",
             "90 %", "median ms", "median s");
  for (auto& [name, tally] : families) tally.print(name);
  all.print("all");
  std::fflush(stdout);
}

void run(const std::string& file, std::uint64_t count) {
  const Suite suite = load_suite(file);
  std::set<std::string> done;
  for (const SuitePoint& point : suite.points) {
    const std::string worlds = point.worlds.to_json()["families"].dump();
    if (!done.insert(worlds).second) continue;
    Planner planner(point.robot->model, patient(point));
    int found = 0;
    for (std::uint64_t i = 0; i < count; ++i)
      found += plan(planner, point.worlds.make(point.robot->model, i), 4, [] {}) > 0 ? 1 : 0;
    fmt::print("{}: a way in {} of {} worlds\n", point.label.empty() ? "all" : point.label, found, count);
    std::fflush(stdout);
  }
  for (const SuitePoint& point : suite.points)
    if (point.controller_params.plan.enabled) print_plans(point, count);
}

}  // namespace
}  // namespace moma

int main(int argc, char** argv) { return moma::suite_program(argc, argv, "WORLDS", moma::run); }
