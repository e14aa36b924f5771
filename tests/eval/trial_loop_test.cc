// The loop of a trial under a plant and a controller that do exactly as told.
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/eval/trial_fixture.h"

namespace moma::test {
namespace {

TEST(TrialLoop, SuccessIsTheStartOfADwellThatLasts) {
  // 0.4 m at 0.5 m/s: within 2 cm of the goal from 0.76 s on, at rest on it from 0.8 s on.
  const TrialOutput out = run_scripted(tiny_spec(), tiny_world(0.4), drive(0.5, 0.8));
  EXPECT_EQ(to_string(out.row.outcome), "success") << out.row.reason;
  EXPECT_DOUBLE_EQ(out.row.time_to_goal_s, 0.76);
  EXPECT_DOUBLE_EQ(out.row.time_end_s, 0.96);  // 0.76 + dwell of 0.2
  EXPECT_EQ(out.row.steps, 48);
  EXPECT_EQ(out.trace.size(), 48u);
  EXPECT_NEAR(out.row.position_error_m, 0.0, 1e-12);
  EXPECT_NEAR(out.row.path_base_m, 0.4, 1e-12);
}

TEST(TrialLoop, PassingThroughTheGoalIsNoSuccess) {
  // 4 cm of tolerance in all, crossed in 0.08 s.
  const TrialOutput out = run_scripted(tiny_spec(), tiny_world(0.4), drive(0.5, 3.0));
  EXPECT_EQ(to_string(out.row.outcome), "stuck") << out.row.reason;
  EXPECT_TRUE(std::isnan(out.row.time_to_goal_s));
}

TEST(TrialLoop, OrientationMustBeWithinToleranceToo) {
  World world = tiny_world(0.0);
  world.goal.X_WG.linear() = Eigen::AngleAxisd(0.06, Vector3::UnitX()).toRotationMatrix();
  EXPECT_EQ(run_scripted(tiny_spec(), world, {}).row.outcome, Outcome::kStuck);
  world.goal.X_WG.linear() = Eigen::AngleAxisd(0.04, Vector3::UnitX()).toRotationMatrix();
  const TrialOutput out = run_scripted(tiny_spec(), world, {});
  EXPECT_EQ(out.row.outcome, Outcome::kSuccess);
  EXPECT_DOUBLE_EQ(out.row.time_to_goal_s, 0.0);
  EXPECT_NEAR(out.row.orientation_error_rad, 0.04, 1e-12);
}

TEST(TrialLoop, CollisionWinsOverADwellThatEndsAtTheSameSample) {
  const auto touch = [](double at) {
    return [at](double time, PlantState&, PlantReport& report) {
      if (time > at - 1e-9) report.contacts.push_back({PairKind::kObject, 3, 1, 0.004, at - 0.01, true});
    };
  };
  World world = tiny_world(0.0);
  world.objects = {sphere("far", {5, 5, 1}, 0.1), sphere("ball", {4, 4, 1}, 0.1)};
  const TrialOutput out = run_scripted(tiny_spec(), world, {}, touch(0.2));
  EXPECT_EQ(to_string(out.row.outcome), "collision");
  EXPECT_EQ(out.row.link, "slide");
  EXPECT_EQ(out.row.object, "ball");
  EXPECT_EQ(out.row.collision_count, 1);
  EXPECT_DOUBLE_EQ(out.row.collision_time_s, 0.19);
  EXPECT_DOUBLE_EQ(out.row.collision_depth_m, 0.004);
  EXPECT_TRUE(std::isnan(out.row.time_to_goal_s));
  EXPECT_EQ(run_scripted(tiny_spec(), world, {}, touch(0.22)).row.outcome, Outcome::kSuccess)
      << "a contact after the dwell comes too late";
  EXPECT_EQ(run_scripted(tiny_spec(), world, {}, touch(0.0)).row.steps, 0) << "a start in contact has no step";
}

TEST(TrialLoop, NamesFloorAndSelfContacts) {
  const auto with = [](PairKind kind, int second) {
    return run_scripted(tiny_spec(), tiny_world(1.0), {},
                        [=](double, PlantState&, PlantReport& report) {
                          report.contacts.push_back({kind, 1, second, 0.0, 0.0, true});
                        })
        .row;
  };
  EXPECT_EQ(with(PairKind::kFloor, -1).object, "floor");
  EXPECT_EQ(with(PairKind::kSelf, 3).object, "self:slide");
  EXPECT_EQ(with(PairKind::kSelf, 3).link, "upper");
}

TEST(TrialLoop, StuckAfterTwoStillHalvesCountedFromZero) {
  // Moves until 1.5 s: the half from 1 to 2 s is not still, those from 2 to 3 and 3 to 4 s are.
  const TrialOutput out = run_scripted(tiny_spec(), tiny_world(3.0), drive(0.2, 1.5));
  EXPECT_EQ(out.row.outcome, Outcome::kStuck);
  EXPECT_DOUBLE_EQ(out.row.time_end_s, 4.0);
  EXPECT_EQ(run_scripted(tiny_spec(), tiny_world(3.0), {}).row.time_end_s, 2.0);
}

TEST(TrialLoop, SlowMotionBelowTheThresholdIsStillAndAboveIsNot) {
  // 0.0005 m in a half of 1 s.
  EXPECT_EQ(run_scripted(tiny_spec(), tiny_world(3.0), drive(0.00045, 99)).row.outcome, Outcome::kStuck);
  EXPECT_EQ(run_scripted(tiny_spec(), tiny_world(3.0), drive(0.00055, 99)).row.outcome, Outcome::kTimeout);
}

TEST(TrialLoop, AShakenRobotIsStuckByItsMeansWhereAnythingIsDisturbed) {
  // Shakes by 4 mm a period about a place that drifts; halves are of 2 s, and a half's mean may be 5 mm from the last.
  const auto shake = [](double drift) {
    return [=, k = 0](const Observation&, StepResult& result) mutable {
      result.command[0] = drift + (k++ % 2 == 0 ? 0.2 : -0.2);
    };
  };
  TrialSpec disturbed = tiny_spec();
  disturbed.disturbances.joints.noise = 1e-4;
  TrialOutput out = run_scripted(disturbed, tiny_world(3.0), shake(0.0));
  EXPECT_EQ(to_string(out.row.outcome), "stuck") << out.row.reason;
  EXPECT_DOUBLE_EQ(out.row.time_end_s, 4.0);
  EXPECT_EQ(out.row.reason.find("nothing moved for 4 s"), 0u) << out.row.reason;
  EXPECT_EQ(run_scripted(disturbed, tiny_world(3.0), shake(0.0024)).row.outcome, Outcome::kStuck);
  EXPECT_EQ(run_scripted(disturbed, tiny_world(3.0), shake(0.0026)).row.outcome, Outcome::kTimeout);
  EXPECT_EQ(run_scripted(tiny_spec(), tiny_world(3.0), shake(0.0003)).row.outcome, Outcome::kStuck)
      << "ends of halves, which shaking by two periods does not move, count where nothing is disturbed";
  disturbed.stuck.ends.time = kInfinity;
  EXPECT_EQ(run_scripted(disturbed, tiny_world(3.0), shake(0.0)).row.outcome, Outcome::kTimeout);
}

TEST(TrialLoop, NotStuckWhileGoalOrObjectsMove) {
  World world = tiny_world(3.0);
  world.goal.motion = PathMotion{{0.0, 5.0},
                                 {world.goal.X_WG.translation(), {3, 1, 0.5}},
                                 {Eigen::Quaterniond::Identity(), Eigen::Quaterniond::Identity()}};
  TrialOutput out = run_scripted(tiny_spec(), world, {});
  EXPECT_EQ(out.row.outcome, Outcome::kStuck);
  EXPECT_DOUBLE_EQ(out.row.time_end_s, 7.0) << "halves count from 5 s, when the goal has come to rest";
  EXPECT_FALSE(std::isnan(out.row.tracking_error_rms));

  world = tiny_world(3.0);
  world.objects = {sphere("walker", {0, 5, 0.5}, 0.1)};
  world.objects[0].motion = LinearMotion{(Vector6() << 0, 0, 0, 0.1, 0, 0).finished()};
  out = run_scripted(tiny_spec(), world, {});
  EXPECT_EQ(out.row.outcome, Outcome::kTimeout);
  EXPECT_DOUBLE_EQ(out.row.time_end_s, 10.0);
  EXPECT_EQ(out.row.steps, 500);
}

TEST(TrialLoop, InfeasibleCountsConsecutiveBrakes) {
  const auto braking = [](int every) {
    return [every, k = 0](const Observation&, StepResult& result) mutable {
      result.status = StepStatus::kInfeasible;
      result.command[0] = 0.1;  // never stuck
      result.fallback = every > 0 && ++k % every == 0 ? Fallback::kRelaxed : Fallback::kBrake;
    };
  };
  TrialOutput out = run_scripted(tiny_spec(), tiny_world(3.0), braking(0));
  EXPECT_EQ(out.row.outcome, Outcome::kInfeasible);
  EXPECT_DOUBLE_EQ(out.row.time_end_s, 0.5);
  EXPECT_EQ(out.row.fallback_brake, 25);
  EXPECT_EQ(out.row.qp_infeasible, 25);
  out = run_scripted(tiny_spec(), tiny_world(3.0), braking(25));  // 24 brakes, then a relaxed step, and again
  EXPECT_EQ(out.row.outcome, Outcome::kTimeout);
  EXPECT_EQ(out.row.fallback_relaxed, 20);
}

// The bend tilts the tool by 0.5 rad/s; its axis starts 0.1 rad off the vertical.
TEST(TrialLoop, ATiltedToolSpillsTheCup) {
  World world = tiny_world(3.0);
  const auto bend = [](const Observation& observation, StepResult& result) {
    ASSERT_TRUE(observation.upright.has_value());
    EXPECT_EQ(observation.upright->angle, 0.305);
    if (observation.time < 0.3 - 1e-9) result.command[3] = 0.5;
  };
  world.upright = Upright{2.0 * Vector3(std::sin(0.1), 0.0, std::cos(0.1)), 0.305};
  const TrialRow kept = run_scripted(tiny_spec(), world, bend).row;
  EXPECT_NE(kept.outcome, Outcome::kSpilled) << kept.reason;
  EXPECT_NEAR(kept.tilt_max_rad, 0.25, 1e-9);
  const auto on = [](const Observation&, StepResult& result) { result.command[3] = 0.5; };
  const TrialRow spilled = run_scripted(tiny_spec(), world, on).row;
  EXPECT_EQ(to_string(spilled.outcome), "spilled");
  EXPECT_NEAR(spilled.tilt_max_rad, 0.31, 1e-9);
  EXPECT_NEAR(spilled.time_end_s, 0.42, 1e-9);
  EXPECT_NE(spilled.reason.find("tilted by 0.31 rad, beyond 0.305 rad"), std::string::npos) << spilled.reason;
  world.upright.reset();
  EXPECT_TRUE(std::isnan(run_scripted(tiny_spec(), world, drive(0.1, 1.0)).row.tilt_max_rad));
}

TEST(TrialLoop, OtherEnds) {
  const auto faulty = [](FakePlant::Fault fault) {
    return run_scripted(tiny_spec(), tiny_world(3.0), drive(0.1, 99), fault).row;
  };
  const TrialRow limit = faulty([](double, PlantState& state, PlantReport&) { state.q[1] = -1.0011; });
  EXPECT_EQ(limit.outcome, Outcome::kJointLimit);
  EXPECT_NE(limit.reason.find("bend"), std::string::npos) << limit.reason;
  EXPECT_NEAR(limit.limit_margin_min, -0.0011, 1e-12);
  EXPECT_EQ(faulty([](double, PlantState& state, PlantReport&) { state.q[1] = -1.0009; }).outcome, Outcome::kTimeout);
  EXPECT_EQ(faulty([](double, PlantState&, PlantReport& report) { report.tipped = true; }).outcome, Outcome::kTipped);
  EXPECT_EQ(faulty([](double, PlantState&, PlantReport& report) { report.diverged = true; }).outcome,
            Outcome::kDiverged);
  const TrialRow nan = faulty([](double time, PlantState& state, PlantReport&) {
    if (time > 0.1) state.q[0] = kAbsent;
  });
  EXPECT_EQ(nan.outcome, Outcome::kDiverged);
  EXPECT_FALSE(std::isnan(nan.position_error_m)) << "the last finite state counts";
  EXPECT_FALSE(std::isnan(nan.path_ee_m));
}

TEST(TrialLoop, ExceptionsAndBadCommandsAreErrorRows) {
  TrialOutput out =
      run_scripted(tiny_spec(), tiny_world(3.0), drive(0.1, 99), [](double time, PlantState&, PlantReport&) {
        if (time > 0.19) throw std::runtime_error("motor on fire");
      });
  EXPECT_EQ(out.row.outcome, Outcome::kError);
  EXPECT_EQ(out.row.reason, "motor on fire");
  EXPECT_EQ(out.row.steps, 10) << "what was done until then is kept";
  EXPECT_GT(out.row.path_base_m, 0.01);

  out = run_scripted(tiny_spec(), tiny_world(3.0), [](const Observation&, StepResult& r) { r.command[1] = kAbsent; });
  EXPECT_EQ(out.row.outcome, Outcome::kError);
  EXPECT_NE(out.row.reason.find("5 finite numbers"), std::string::npos) << out.row.reason;
  out = run_scripted(tiny_spec(), tiny_world(3.0), [](const Observation&, StepResult& r) { r.command.resize(2); });
  EXPECT_EQ(out.row.outcome, Outcome::kError);
}

TEST(TrialLoop, TheControllerSeesTheStateBeforeItsCommand) {
  std::vector<double> seen;
  const TrialOutput out = run_scripted(tiny_spec(), tiny_world(3.0), [&seen](const Observation& o, StepResult& result) {
    seen.push_back(o.base.x());
    EXPECT_NEAR(o.qdot[0], o.time > 0 ? 0.5 : 0.0, 0.0);
    result.command[0] = 0.5;
  });
  ASSERT_EQ(seen.size(), out.trace.size());
  for (std::size_t k = 0; k < seen.size(); k += 50) {
    EXPECT_NEAR(seen[k], 0.01 * static_cast<double>(k), 1e-12);
    EXPECT_EQ(out.trace[k].base.x(), seen[k]);
    EXPECT_EQ(out.trace[k].command[0], 0.5);
    EXPECT_DOUBLE_EQ(out.trace[k].t, 0.02 * static_cast<double>(k));
    EXPECT_NEAR(out.trace[k].error[3], 3.0 - seen[k], 1e-12) << "linear part last";
  }
}

// The goal 5 cm ahead and as much to the side, and turned by 0.1 rad in the end effector's own axes.
TEST(Clock, SuccessByTheSumOfThePosesParts) {
  TrialSpec spec = tiny_spec();
  spec.success = {.position = 10.0, .orientation = 3.0, .dwell = 0.0};
  World world = tiny_world(0.05);
  world.goal.X_WG.translation().y() += 0.05;
  world.goal.X_WG.linear() = Eigen::AngleAxisd(0.1, Vector3::UnitY()).toRotationMatrix() * world.goal.X_WG.linear();
  spec.simulation.time_limit = 0.1;
  for (const auto& [limit, outcome] :
       std::vector<std::pair<double, Outcome>>{{0.2001, Outcome::kSuccess}, {0.1999, Outcome::kTimeout}}) {
    spec.success.l1 = limit;
    EXPECT_EQ(run_scripted(spec, world, drive(0.0, 0.0)).row.outcome, outcome) << limit;
  }
}

}  // namespace
}  // namespace moma::test
