#include "tests/support/rrt_connect.h"

#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <utility>

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace moma::test {
namespace {

/// Configurations between which moma's edges lead.
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
    return std::sqrt(limits_.distance_squared(get(a), get(b)));
  }
  bool isMetricSpace() const override { return false; }

 private:
  const MotionLimits& limits_;
};

/// Edges are checked as moma checks them.
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

}  // namespace

RrtConnectWay ask_rrt_connect(FreeSpace& space, const WholeConfiguration& start, const Isometry& X_WG,
                              std::span<const GoalConfiguration> goals, int most_goals, double step, long most_checks) {
  ompl::msg::setLogLevel(ompl::msg::LOG_ERROR);
  static const bool seeded = (ompl::RNG::setSeed(1), true);  // once a process: OMPL refuses a second time
  static_cast<void>(seeded);
  const std::clock_t begin = std::clock();
  const MotionLimits& limits = space.limits();
  const bool mobile = limits.mobile();
  auto edges = std::make_shared<EdgeSpace>(limits);
  ob::RealVectorBounds bounds(static_cast<unsigned>(start.size()));
  for (unsigned i = 0; i < start.size(); ++i) {
    const double goal = i < 2 ? X_WG.translation()[i] : start[i];
    const double least = std::min(start[i], goal), most = std::max(start[i], goal);
    bounds.setLow(i, i > 2 ? space.lower()[i - 3] : !mobile ? start[i] - 1e-9 : i < 2 ? least - 1.5 : -3.2);
    bounds.setHigh(i, i > 2 ? space.upper()[i - 3] : !mobile ? start[i] + 1e-9 : i < 2 ? most + 1.5 : 3.2);
  }
  edges->setBounds(bounds);
  auto info = std::make_shared<ob::SpaceInformation>(edges);
  info->setStateValidityChecker([&](const ob::State* s) { return space.free(edges->get(s)); });
  info->setMotionValidator(std::make_shared<EdgeValidator>(info, space, step));
  info->setup();
  auto problem = std::make_shared<ob::ProblemDefinition>(info);
  ob::ScopedState<> from(edges);
  EdgeSpace::set(start, from.get());
  problem->addStartState(from);
  auto ends = std::make_shared<ob::GoalStates>(info);
  for (const GoalConfiguration& goal : goals.first(std::min(goals.size(), static_cast<std::size_t>(most_goals)))) {
    ob::ScopedState<> end(edges);
    WholeConfiguration c = goal.c;
    if (mobile) c[2] = wrapped(c[2]);
    EdgeSpace::set(c, end.get());
    if (info->isValid(end.get())) ends->addState(end);
  }
  problem->setGoal(ends);
  og::RRTConnect planner(info);
  planner.setProblemDefinition(problem);
  planner.setRange(0.8);
  planner.setup();
  const long before = space.checks();
  RrtConnectWay way;
  if (!ends->hasStates()) return way;  // for which the search would wait without an end
  const ob::PlannerTerminationCondition over([&] { return space.checks() - before > most_checks; });
  if (planner.solve(over) == ob::PlannerStatus::EXACT_SOLUTION) {
    way.found = true;
    auto& path = *problem->getSolutionPath()->as<og::PathGeometric>();
    og::PathSimplifier(info).reduceVertices(path, 60);
    for (unsigned i = 1; i < path.getStateCount(); ++i) {
      const WholeConfiguration a = edges->get(path.getState(i - 1)), b = edges->get(path.getState(i));
      way.time += edge_time(limits, a, b);
      way.length += (b - a).tail(b.size() - 3).norm();
    }
  }
  way.checks = space.checks() - before;
  way.seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  return way;
}

}  // namespace moma::test
