// The search against OMPL's RRT-Connect on the same queries: the same configurations, edges, distances and goal
// configurations, as many checks. Another program's trees, samples and shortcuts.
#include <gtest/gtest.h>
#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <chrono>
#include <cstdio>

#include "tests/controller/plan_scenes.h"

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace moma::test {
namespace {

// Configurations between which moma's edges lead.
class EdgeSpace : public ob::RealVectorStateSpace {
 public:
  explicit EdgeSpace(const MotionLimits& limits)
      : ob::RealVectorStateSpace(static_cast<unsigned>(3 + limits.num_joints())), limits_(limits) {}

  WholeConfiguration get(const ob::State* state) const {
    WholeConfiguration c(3 + limits_.num_joints());
    for (Eigen::Index i = 0; i < c.size(); ++i) c[i] = state->as<StateType>()->values[i];
    return c;
  }
  static void set(const WholeConfiguration& c, ob::State* state) {
    for (Eigen::Index i = 0; i < c.size(); ++i) state->as<StateType>()->values[i] = c[i];
  }
  void interpolate(const ob::State* from, const ob::State* to, double t, ob::State* out) const override {
    Edge edge;
    make_edge(limits_, get(from), get(to), edge);
    WholeConfiguration c;
    edge_at(limits_, edge, t * edge.time, c);
    set(c, out);
  }
  double distance(const ob::State* a, const ob::State* b) const override {
    return std::sqrt(distance_squared(get(a), get(b)));
  }
  bool isMetricSpace() const override { return false; }

 private:
  const MotionLimits& limits_;
};

// Edges are checked as moma checks them.
class EdgeValidator : public ob::MotionValidator {
 public:
  EdgeValidator(const ob::SpaceInformationPtr& info, FreeSpace& space, double step)
      : ob::MotionValidator(info), space_(space), step_(step) {}
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    const auto* space = si_->getStateSpace()->as<EdgeSpace>();
    Edge edge;
    make_edge(space_.limits(), space->get(a), space->get(b), edge);
    return space_.free(edge, step_);
  }
  bool checkMotion(const ob::State* a, const ob::State* b, std::pair<ob::State*, double>& last) const override {
    if (checkMotion(a, b)) return true;
    last.second = 0.0;
    if (last.first != nullptr) si_->copyState(last.first, a);
    return false;
  }

 private:
  FreeSpace& space_;
  double step_;
};

struct Answer {
  bool found = false;
  double time = 0.0;  // of its edges [s]
  double seconds = 0.0;
};

Answer ask_ompl(const std::shared_ptr<const RobotModel>& model, const ControllerParams& params, const Scene& scene,
                std::span<const GoalConfiguration> goals, const Clearances& clearances, const MotionLimits& limits,
                std::uint64_t seed, long most_checks) {
  const auto begin = std::chrono::steady_clock::now();
  FreeSpace free(model, limits);
  free.set_objects(scene.shapes);
  free.set_states(scene.states);
  free.set_clearances(clearances, scene.start);
  ompl::RNG::setSeed(seed + 1);
  auto space = std::make_shared<EdgeSpace>(limits);
  ob::RealVectorBounds bounds(static_cast<unsigned>(scene.start.size()));
  const bool mobile = limits.mobile();
  for (unsigned i = 0; i < scene.start.size(); ++i) {
    const double goal = i < 2 ? scene.X_WG.translation()[i] : 0.0;
    bounds.setLow(i, i > 2 ? free.lower()[i - 3] : !mobile ? -1e-9 : i < 2 ? std::min(0.0, goal) - 1.5 : -3.2);
    bounds.setHigh(i, i > 2 ? free.upper()[i - 3] : !mobile ? 1e-9 : i < 2 ? std::max(0.0, goal) + 1.5 : 3.2);
  }
  space->setBounds(bounds);
  auto info = std::make_shared<ob::SpaceInformation>(space);
  info->setStateValidityChecker([&](const ob::State* s) { return free.free(space->get(s)); });
  info->setMotionValidator(std::make_shared<EdgeValidator>(info, free, params.plan.check_step));
  info->setup();
  auto problem = std::make_shared<ob::ProblemDefinition>(info);
  ob::ScopedState<> start(space);
  EdgeSpace::set(scene.start, start.get());
  problem->addStartState(start);
  auto ends = std::make_shared<ob::GoalStates>(info);
  for (std::size_t i = 0; i < goals.size() && static_cast<int>(i) < params.plan.roots; ++i) {
    ob::ScopedState<> end(space);
    WholeConfiguration c = goals[i].c;
    if (mobile) c[2] = wrapped(c[2]);
    EdgeSpace::set(c, end.get());
    ends->addState(end);
  }
  problem->setGoal(ends);
  og::RRTConnect planner(info);
  planner.setProblemDefinition(problem);
  planner.setRange(0.8);
  planner.setup();
  const long before = free.checks();
  Answer answer;
  const ob::PlannerTerminationCondition over([&] { return free.checks() - before > most_checks; });
  if (planner.solve(over) == ob::PlannerStatus::EXACT_SOLUTION) {
    answer.found = true;
    auto& path = *problem->getSolutionPath()->as<og::PathGeometric>();
    og::PathSimplifier simplifier(info);
    simplifier.reduceVertices(path, 60);
    Edge edge;
    for (std::size_t i = 1; i < path.getStateCount(); ++i) {
      make_edge(limits, space->get(path.getState(static_cast<unsigned>(i - 1))),
                space->get(path.getState(static_cast<unsigned>(i))), edge);
      answer.time += edge.time;
    }
  }
  answer.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return answer;
}

class AgainstOmpl : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(Robots, AgainstOmpl, testing::ValuesIn(plan_robots()),
                         [](const auto& param) { return test_name(param.param); });

TEST_P(AgainstOmpl, FindsWaysAsOftenAndAsQuick) {
  ompl::msg::setLogLevel(ompl::msg::LOG_ERROR);
  const auto model = load_model(GetParam());
  ControllerParams params = plan_params(*model);
  params.plan.roomy = params.plan.clearance;  // a single clearance, so that both search the same space
  Planner planner(model, params);
  const Clearances clearances{params.plan.clearance, params.plan.self, params.plan.self};
  int ours = 0, theirs = 0, asked = 0;
  std::vector<double> ratios;
  double our_seconds = 0.0, their_seconds = 0.0, our_time = 0.0, their_time = 0.0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    const Scene scene = make_scene(model, seed, 25);
    const auto begin = std::chrono::steady_clock::now();
    plan_whole(planner, scene, seed);
    our_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (planner.goals().empty()) continue;
    ++asked;
    const Answer answer =
        ask_ompl(model, params, scene, planner.goals(), clearances, planner.limits(), seed, params.plan.checks);
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
