// Plans from start to goal, without a robot that moves. What moves is left out, and a goal in motion is taken where it
// begins.
//
//   moma_bench_plans SUITE [WORLDS]
//
// For each sweep point of a suite, whatever its controllers: in how many of its first worlds a planner with much work
// at its hands finds a path of base and arm that keeps the clearance of a tight path. Of a world without one it is
// unknown whether there is any. For each controller that looks ahead: what its own planner needs in these worlds, by
// family, where it begins again after each failure as the controller does. Where OMPL is installed, its RRT-Connect
// searches as well, once in each of these worlds: the same start, goal configurations, distances and edges.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "bench/suite_program.h"
#include "controller/plan/planner.h"
#include "eval/suite/suite.h"
#ifdef MOMA_HAVE_OMPL
#include "tests/support/rrt_connect.h"
#endif

namespace moma {
namespace {

[[maybe_unused]] constexpr long kMostOfOmpl = 400000;

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

/// What came of a world: `first`: by the first plan; checks and processor time [s] of all plans; duration [s] of the
/// way and its length in joint space [rad].
struct Answer {
  bool found = false, first = false;
  double checks = 0.0, seconds = 0.0, time = 0.0, length = 0.0;
};

/// Answers; numbers of those that were found.
struct Tally {
  int worlds = 0, found = 0, first = 0;
  std::vector<double> checks, seconds, times, lengths;

  void add(const Answer& answer) {
    ++worlds;
    if (!answer.found) return;
    ++found;
    first += answer.first ? 1 : 0;
    checks.push_back(answer.checks);
    seconds.push_back(answer.seconds);
    times.push_back(answer.time);
    lengths.push_back(answer.length);
  }
  void print(const std::string& name) {
    const auto at = [](std::vector<double>& values, double part) {
      if (values.empty()) return 0.0;
      const auto k = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1) + 0.5);
      std::nth_element(values.begin(), values.begin() + k, values.end());
      return values[static_cast<std::size_t>(k)];
    };
    fmt::print("{:24} {:6} {:6} {:6} {:10.0f} {:10.0f} {:10.2f} {:8.2f} {:10.2f}\n", name, worlds, found, first,
               at(checks, 0.5), at(checks, 0.9), 1e3 * at(seconds, 0.5), at(times, 0.5), at(lengths, 0.5));
  }
};

using Tallies = std::map<std::string, Tally>;  // of families, and of all worlds

void add(Tallies& tallies, const World& world, const Answer& answer) {
  tallies[world.family].add(answer);
  tallies["~ all"].add(answer);  // after the families' names
}

/// Length in joint space [rad]; 0 of a path past corners, which has no edges.
double length_of(std::span<const Edge> edges) {
  double length = 0.0;
  for (const Edge& edge : edges) length += (edge.b - edge.a).tail(edge.a.size() - 3).norm();
  return length;
}

void print(const std::string& title, Tallies& tallies) {
  fmt::print("\n{}; checks until then; processor time; duration and length of the way\n", title);
  fmt::print("{:24} {:>6} {:>6} {:>6} {:>10} {:>10} {:>10} {:>8} {:>10}\n", "family", "worlds", "found", "first",
             "median", "90 %", "median ms", "median s", "median rad");
  for (auto& [name, tally] : tallies) tally.print(name);
  std::fflush(stdout);
}

void print_plans(const SuitePoint& point, std::uint64_t count) {
  constexpr int kMost = 10;
  Planner planner(point.robot->model, resolved(point.controller_params, *point.robot->model));
  Tallies ours;
  [[maybe_unused]] Tallies of_ompl;
  for (std::uint64_t i = 0; i < count; ++i) {
    const World world = point.worlds.make(point.robot->model, i);
    const std::clock_t begin = std::clock();
    double checks = 0.0;
    const int plans = plan(planner, world, kMost, [&] { checks += static_cast<double>(planner.counts().checks); });
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    add(ours, world,
        {plans > 0, plans == 1, checks, seconds, planner.path().duration, length_of(planner.edges().all())});
#ifdef MOMA_HAVE_OMPL
    if (plans == 0) continue;
    const PlanParams& params = point.controller_params.plan;
    const test::RrtConnectWay way =
        test::ask_rrt_connect(planner.space(), start_of(world), world.goal.X_WG, planner.goals(), params.roots,
                              params.check_step, kMostOfOmpl);
    add(of_ompl, world, {way.found, way.found, static_cast<double>(way.checks), way.seconds, way.time, way.length});
#endif
  }
  print(fmt::format("{} {}: found in {} plans, in the first one", point.controller, point.label, kMost), ours);
#ifdef MOMA_HAVE_OMPL
  print(fmt::format("OMPL's RRT-Connect where that found a way: found within {} checks", kMostOfOmpl), of_ompl);
#endif
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
