// In how many worlds there is a way: a planner with much work at its hands, from start to goal, once and for all.
//
//   moma_bench_plans SUITE [WORLDS]
//
// For each sweep point of a suite, whatever its controllers: how many of its first worlds have a path of base and arm
// that keeps the clearance of a tight path. What moves is left out, and a goal in motion is taken where it begins. Of a
// world without one it is unknown whether there is any.
#include <fmt/format.h>

#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include "bench/suite_program.h"
#include "controller/plan/planner.h"
#include "eval/suite/suite.h"

namespace moma {
namespace {

/// As the preset that looks ahead plans, and far longer.
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

bool has_way(Planner& planner, const World& world) {
  planner.set_objects(object_shapes(world));
  std::vector<ObjectState> states(world.objects.size());
  object_states(world, 0.0, states);
  WholeConfiguration start(3 + world.start.q.size());
  start << world.start.base, world.start.q;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    planner.begin(start, world.goal.X_WG, states, seed);
    long budget = 1L << 40;
    planner.advance(budget);
    if (planner.found()) return true;
  }
  return false;
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
      found += has_way(planner, point.worlds.make(point.robot->model, i)) ? 1 : 0;
    fmt::print("{}: a way in {} of {} worlds\n", point.label.empty() ? "all" : point.label, found, count);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace moma

int main(int argc, char** argv) { return moma::suite_program(argc, argv, "WORLDS", moma::run); }
