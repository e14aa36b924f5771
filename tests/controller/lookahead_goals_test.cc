// The look-ahead copes with goals that jump, are passed or missed, or lie beside the end of a path.
#include <gtest/gtest.h>

#include <variant>

#include "tests/controller/lookahead_loop.h"

namespace moma::test {
namespace {

class AheadOfGoals : public Ahead {};

INSTANTIATE_TEST_SUITE_P(Robots, AheadOfGoals, testing::ValuesIn(lookahead_robots()),
                         [](const auto& param) { return test_name(param.param); });

// True if the robot follows the path to the goal before.
bool follows_former(const PlanState& state) {
  const auto* following = std::get_if<Following>(&state.doing);
  return following != nullptr && following->former;
}

// A goal that jumps while the robot follows a path is gone on to from the velocity that it has.
TEST_P(AheadOfGoals, GoesOnToTheNextGoalWithoutComingToRest) {
  int gone_on = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Scene scene = make_scene(model, seed, 0);
    Loop loop(model, read_params(*model, true), scene);
    const PlanState& state = loop.controller.lookahead()->state();
    loop.step();
    for (int i = 0; i < 100 && !(state.brief.mode == PlanMode::kFollow && state.brief.clock > 0.4); ++i) loop.step();
    ASSERT_EQ(state.brief.reason, PlanReason::kDirectWay) << "seed " << seed;
    loop.o.goal.X_WG.translation() += Vector3(0.05, 0.05, -0.08);
    loop.step();
    EXPECT_EQ(state.brief.mode, PlanMode::kFollow) << "seed " << seed;
    double slowest = kInfinity;
    int steps = 0;
    for (; follows_former(state) && steps < 20; ++steps) {
      loop.step();
      slowest = std::min(slowest, loop.o.qdot.lpNorm<Eigen::Infinity>());
    }
    EXPECT_LE(steps, 7) << "seed " << seed;
    if (state.brief.mode != PlanMode::kFollow) continue;
    ++gone_on;
    EXPECT_EQ(state.brief.reason, PlanReason::kDirectWay) << "seed " << seed;
    EXPECT_LT(state.brief.lag, 0.05) << "it begins where the robot is";
    EXPECT_GT(slowest, 0.1) << "seed " << seed;
  }
  EXPECT_GE(gone_on, 3);
}

// A goal that need not be stopped at is passed on the way to the next one, which is told; one that is missed is gone
// back to and stopped at.
TEST_P(AheadOfGoals, PassesAGoalOnItsWayToTheNextOne) {
  double fastest = 0.0;  // of the base at a goal
  int gone_on = 0, misses = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Scene scene = make_scene(model, seed, 0);
    const GoalState next{make_scene(model, seed + 100, 0).X_WG};
    const auto run = [&](bool missed) {
      Loop loop(model, read_params(*model, true), scene);
      const PlanState& state = loop.controller.lookahead()->state();
      loop.o.goal.stop = false;
      loop.o.next = next;
      double rest = -1.0, at = -1.0;
      bool was_missed = false;
      for (int i = 0; i < 1500; ++i) {
        loop.step();
        was_missed = was_missed || state.missed;
        const Vector6& e = loop.result.error;
        const bool near = e.tail<3>().norm() < 0.02 && e.head<3>().norm() < 0.05;
        if (!near || loop.o.time < 0.1) continue;
        if (at >= 0.0) {
          rest = loop.o.time;
          break;
        }
        if (missed && !was_missed) continue;
        at = loop.o.time;
        if (!missed && model->mobile()) fastest = std::max(fastest, std::abs(loop.o.qdot[0]));
        loop.o.goal = next;
        loop.o.next.reset();
        if (!missed) {
          const Path before = state.path;
          loop.step();
          gone_on += before.passes() && state.brief.mode == PlanMode::kFollow && !follows_former(state) ? 1 : 0;
        }
      }
      if (missed) {
        EXPECT_TRUE(was_missed) << "seed " << seed;
      }
      misses += !missed && was_missed ? 1 : 0;
      EXPECT_GT(rest, 0.0) << "seed " << seed;
    };
    run(false);
    if (seed == 1) run(true);
  }
  EXPECT_GE(gone_on, 3);
  EXPECT_LE(misses, 1);
  if (model->mobile()) {
    EXPECT_GT(fastest, 0.25);
  }
}

// A robot that something holds back just before a goal that it would pass does not wait there for the path's clock.
TEST_P(AheadOfGoals, ARobotThatIsHeldWhereItPassesAGoalHasMissedIt) {
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Loop loop(model, read_params(*model, true), make_scene(model, seed, 0));
    const PlanState& state = loop.controller.lookahead()->state();
    loop.o.goal.stop = false;
    loop.o.next = GoalState{make_scene(model, seed + 100, 0).X_WG};
    const auto passes_soon = [&] { return state.path.passes() && state.brief.clock > state.path.pass - 0.12; };
    for (int i = 0; i < 500 && !passes_soon(); ++i) loop.step();
    ASSERT_TRUE(passes_soon()) << "seed " << seed;
    loop.o.qdot.setZero();
    double clock = 0.0, pass = 0.0;
    for (int i = 0; i < 200 && !state.missed && state.path.passes(); ++i) {
      clock = state.brief.clock;
      pass = state.path.pass;
      loop.controller.step(loop.o, loop.result);
      loop.o.time += kPeriod;
    }
    held += state.missed && clock >= pass && clock < pass + 0.3 ? 1 : 0;
    EXPECT_FALSE(state.path.passes()) << "seed " << seed << ": it waits at " << clock << " of " << pass << " s";
  }
  EXPECT_GE(held, 1) << "no clock stands after the passing";
}

// On the way the goal is measured better than before: it lies beside the path's end, by less than what counts as there.
TEST_P(AheadOfGoals, ClosesInOnTheGoalWhereHoldingAPathsEndDoesNotDo) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Loop loop(model, read_params(*model, true), make_scene(model, seed, 0));
    const PlanState& state = loop.controller.lookahead()->state();
    loop.step();
    for (int i = 0; i < 100 && !(state.brief.mode == PlanMode::kFollow && state.brief.clock > 0.4); ++i) loop.step();
    ASSERT_EQ(state.brief.reason, PlanReason::kDirectWay) << "seed " << seed;
    loop.o.goal.X_WG.translation().z() += 0.008;
    for (int i = 0; i < 400; ++i) loop.step();
    EXPECT_LT(loop.result.error.tail<3>().norm(), 0.001)
        << "seed " << seed << ", in mode " << to_string(state.brief.mode) << " since " << to_string(state.brief.reason)
        << ", " << state.steps_beside << " steps beside the goal";
  }
}

// A robot whose hand is measured now within what counts as there and now outside, and whose base cannot move across.
TEST_P(AheadOfGoals, ClosesInOnTheGoalFromTheEdgeOfWhatCountsAsThere) {
  const ControllerParams params = read_params(*model, true);
  const double edge = params.plan.decisions.tolerance * params.escape.position;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Loop loop(model, params, make_scene(model, seed, 0));
    const PlanState& state = loop.controller.lookahead()->state();
    const Vector3 goal = loop.o.goal.X_WG.translation();
    Vector3 across = Vector3::Zero();
    for (int i = 0; i < 600; ++i) {
      loop.step();
      const bool at_end = state.brief.mode == PlanMode::kFollow && state.brief.clock >= state.path.duration;
      if (at_end && across.isZero()) across << -std::sin(loop.o.base.z()), std::cos(loop.o.base.z()), 0.0;
      loop.o.goal.X_WG.translation() = goal + (edge + (i % 2 == 0 ? 0.001 : -0.001)) * across;
    }
    ASSERT_FALSE(across.isZero()) << "seed " << seed << ": no path ended";
    EXPECT_LT(loop.result.error.tail<3>().norm(), 0.005)
        << "seed " << seed << ", in mode " << to_string(state.brief.mode) << " since " << to_string(state.brief.reason);
  }
}

// Where the policy is predicted to arrive from there, it takes the robot to the goal, though a direct way is quicker.
TEST_P(AheadOfGoals, WhatHoldsTheRobotOffTheEndOfAPathDoesSoOnce) {
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Loop loop(model, read_params(*model, true), make_scene(model, seed, 0));
    const PlanState& state = loop.controller.lookahead()->state();
    const auto ends_soon = [&] {
      return state.brief.mode == PlanMode::kFollow && state.brief.clock > state.path.duration - 0.3;
    };
    for (int i = 0; i < 500 && !ends_soon(); ++i) loop.step();
    ASSERT_TRUE(ends_soon()) << "seed " << seed;
    loop.o.qdot.setZero();
    for (int i = 0; i < 150 && state.brief.mode == PlanMode::kFollow; ++i) {
      loop.controller.step(loop.o, loop.result);
      loop.o.time += kPeriod;
    }
    if (!state.held_off) continue;
    ++held;
    loop.o.q[1] += 0.3;  // far enough for a choice
    for (int i = 0; i < 500 && !loop.there(); ++i) {
      loop.step();
      ASSERT_EQ(state.brief.mode, PlanMode::kDirect) << "seed " << seed << ": " << to_string(state.brief.reason);
    }
    EXPECT_TRUE(loop.there()) << "seed " << seed;
  }
  EXPECT_GE(held, 1) << "no robot is held at an end";
}

// The policy takes over where it is predicted to arrive; in the last part of paths to one goal once.
TEST_P(AheadOfGoals, LeavesTheLastPartOfAPathOnce) {
  if (!model->mobile()) GTEST_SKIP() << "only for a mobile robot";
  const Scene scene = behind_a_wall(model, 1);
  ControllerParams params = read_params(*model, true);
  params.plan.direct = 0;
  params.plan.decisions.last_part = 100.0;
  Loop loop(model, params, scene);
  const PlanState& state = loop.controller.lookahead()->state();
  const auto policy_arrives = [&] {
    return state.brief.mode == PlanMode::kDirect && state.brief.reason == PlanReason::kArrives;
  };
  ControllerMemory memory;
  Observation o;
  for (int i = 0; i < 1000 && !policy_arrives(); ++i) {
    if (state.brief.mode == PlanMode::kFollow) {
      loop.controller.get_memory(memory);
      o = loop.o;
    }
    loop.step();
  }
  ASSERT_TRUE(policy_arrives());
  EXPECT_TRUE(state.left_last_part);

  // From the last step on the path, had it been left before.
  ASSERT_EQ(memory.plan.brief.mode, PlanMode::kFollow);
  memory.plan.left_last_part = true;
  loop.controller.set_memory(memory);
  loop.o = o;
  for (int i = 0; i < 1000 && !loop.there(); ++i) {
    loop.step();
    ASSERT_FALSE(policy_arrives()) << "at " << state.brief.clock << " of " << state.brief.duration << " s";
  }
  EXPECT_TRUE(loop.there());
  loop.o.goal.X_WG.translation().x() += 0.3;
  loop.step();
  EXPECT_FALSE(state.left_last_part) << "another goal";
}

}  // namespace
}  // namespace moma::test
