// The search against OMPL's RRT-Connect on the same queries: the same configurations, edges, distances and goal
// configurations, as many checks. Another program's trees, samples and shortcuts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

#include "tests/controller/plan_scenes.h"
#include "tests/support/rrt_connect.h"

namespace moma::test {
namespace {

class AgainstOmpl : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Robots, AgainstOmpl, testing::ValuesIn(plan_robots()),
                         [](const auto& param) { return test_name(param.param); });

TEST_P(AgainstOmpl, FindsWaysAsOftenAndAsQuick) {
  const auto model = load_model(GetParam());
  ControllerParams params = plan_params(*model);
  params.plan.roomy = params.plan.clearance;  // a single clearance, so that both search the same space
  params.plan.smooth.tries = 0;               // no routes and no paths past corners, which OMPL does not look for
  Planner planner(model, params);
  const Clearances clearances{params.plan.clearance, params.plan.self, params.plan.self};
  int ours = 0, theirs = 0, asked = 0;
  std::vector<double> ratios;
  double our_seconds = 0.0, their_seconds = 0.0, our_time = 0.0, their_time = 0.0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const Scene scene = make_scene(model, seed, 25);
    const std::clock_t begin = std::clock();
    plan_whole(planner, scene, seed);
    our_seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    if (planner.goals().empty()) continue;
    ++asked;
    FreeSpace space(model, planner.limits());
    space.set_objects(scene.shapes);
    space.set_states(scene.states);
    space.set_clearances(clearances, scene.start);
    const RrtConnectWay answer = ask_rrt_connect(space, scene.start, scene.X_WG, planner.goals(), params.plan.roots,
                                                 params.plan.check_step, params.plan.checks);
    their_seconds += answer.seconds;
    ours += planner.found() ? 1 : 0;
    theirs += answer.found ? 1 : 0;
    if (!planner.found() || !answer.found) continue;
    our_time += planner.edges().time();
    their_time += answer.time;
    ratios.push_back(planner.edges().time() / answer.time);
  }
  std::sort(ratios.begin(), ratios.end());
  ASSERT_FALSE(ratios.empty());
  const double median = ratios[ratios.size() / 2];
  std::printf(
      "%d queries: found %d, OMPL %d; mean time of the way %.2f s, OMPL %.2f s, median ratio %.2f; "
      "computed in %.1f ms a query (goal configurations and four runs included), OMPL %.1f ms\n",
      asked, ours, theirs, our_time / static_cast<double>(ratios.size()),
      their_time / static_cast<double>(ratios.size()), median, 1e3 * our_seconds / 24, 1e3 * their_seconds / 24);
  EXPECT_GE(asked, 12);
  EXPECT_GE(ours, theirs - 1);
  EXPECT_LE(median, 1.05);
}

}  // namespace
}  // namespace moma::test
