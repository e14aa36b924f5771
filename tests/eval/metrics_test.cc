// Metrics against values known in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "eval/trial/metrics.h"
#include "tests/eval/trial_fixture.h"

namespace moma::test {
namespace {

constexpr double kDt = 0.02;

// n steps of the tiny robot whose base moves by `x(t)` and whose first joint by `q(t)`; the tip by (x, 0, 0).
template <typename X, typename Q>
Recording recording(int n, X x, Q q) {
  Recording r;
  r.control_period = kDt;
  for (int k = 0; k <= n; ++k) {
    const double t = kDt * k;
    StateRecord state;
    state.p_WE = Vector3(x(t), 0, 0);
    r.states.push_back(state);
    Sample sample;
    sample.t = t;
    sample.base = Vector3(x(t), 0, 0);
    sample.q = Vector3(q(t), 0, 0);
    sample.qdot = VectorX::Zero(5);
    sample.command = VectorX::Zero(5);
    if (k < n) {
      r.trace.push_back(sample);
    } else {
      r.last.base = sample.base;
      r.last.q = sample.q;
    }
  }
  return r;
}

TEST(Metrics, JerkOfACubicIsItsThirdDerivative) {
  const TrialRow row =
      measure(recording(
                  50, [](double t) { return 0.5 * t * t * t; }, [](double t) { return 2 * t * t * t; }),
              *tiny_robot());
  EXPECT_NEAR(row.jerk_ee_rms, 3.0, 1e-7);  // d^3/dt^3 of t^3/2
  EXPECT_NEAR(row.jerk_joint_rms, 12.0, 1e-7);
}

TEST(Metrics, JerkOfASineIsRootMeanSquare) {
  const double w = 2 * M_PI;
  const TrialRow row = measure(recording(
                                   500, [&](double t) { return std::sin(w * t); }, [](double) { return 0.0; }),
                               *tiny_robot());
  EXPECT_NEAR(row.jerk_ee_rms, w * w * w / std::sqrt(2.0), 0.01 * w * w * w);
  EXPECT_EQ(row.jerk_joint_rms, 0.0);
}

TEST(Metrics, PathsMarginsAndErrors) {
  Recording r = recording(
      100, [](double t) { return std::abs(1.0 - t); }, [](double t) { return t; });
  r.moving_goal = true;
  for (std::size_t k = 0; k < r.states.size(); ++k) {
    r.states[k].position_error = k % 2 == 0 ? 0.3 : 0.4;
    r.states[k].manipulability = 0.1 + 0.001 * static_cast<double>(k);
  }
  const TrialRow row = measure(r, *tiny_robot());
  EXPECT_NEAR(row.path_ee_m, 2.0, 1e-12);
  EXPECT_NEAR(row.path_base_m, 2.0, 1e-12);
  EXPECT_NEAR(row.limit_margin_min, 0.0, 1e-12) << "turn reaches its limit of 2 at the last state";
  EXPECT_NEAR(row.tracking_error_rms, std::sqrt((51 * 0.09 + 50 * 0.16) / 101), 1e-12);
  EXPECT_NEAR(row.manip_min, 0.1, 1e-12);
  EXPECT_NEAR(row.manip_final, 0.2, 1e-12);
  EXPECT_NEAR(row.manip_mean, 0.15, 1e-12);
  EXPECT_EQ(row.position_error_m, 0.3);
}

TEST(Metrics, PhasesShareTheTrialsTime) {
  Recording r = recording(
      11, [](double) { return 0.0; }, [](double) { return 0.0; });
  r.success = {.position = 0.02, .orientation = 0.05};
  // Share of the base's 1 m/s, distance and angle to the goal at the beginning of each control period of 0.02 s.
  const double shares[]{0.0, 0.019, 0.1, 0.2, 0.203, 0.2, 0.1, 0.1, 0.1, 0.0, 0.0};
  for (std::size_t k = 0; k < 12; ++k) {
    r.states[k].position_error = k < 7 ? 0.5 : k < 8 ? 0.03 : 0.01;
    r.states[k].orientation_error = k < 9 ? 0.2 : 0.01;
    if (k < 11) r.trace[k].command[1] = -shares[k];
  }
  const TrialRow row = measure(r, *tiny_robot());
  EXPECT_NEAR(row.phase_standing_s, 0.04, 1e-12);
  EXPECT_NEAR(row.phase_speeding_up_s, 0.04, 1e-12);
  EXPECT_NEAR(row.phase_cruise_s, 0.04, 1e-12);
  EXPECT_NEAR(row.phase_slowing_down_s, 0.02, 1e-12);
  EXPECT_NEAR(row.phase_last_5_cm_s, 0.02, 1e-12);
  EXPECT_NEAR(row.phase_turning_s, 0.02, 1e-12);
  EXPECT_NEAR(row.phase_dwell_s, 0.04, 1e-12);
}

TEST(Metrics, CommandChangeIsTheLargestShareOfALimit) {
  Recording r = recording(
      3, [](double) { return 0.0; }, [](double) { return 0.0; });
  r.trace[1].command << 0.5, 0.0, 0.3, 0, 0;    // 0.5 of 1, 0.2 of 1.5
  r.trace[2].command << 0.4, 1.0, 0.3, 0, 0.4;  // 0.1 of 1, 0.5 of 2, 0, 0.8 of 0.5
  EXPECT_NEAR(measure(r, *tiny_robot()).command_change_mean, (0.5 + 0.8) / 2, 1e-12);
}

TEST(Metrics, SlackCountsAndTimings) {
  Recording r = recording(
      4, [](double) { return 0.0; }, [](double) { return 0.0; });
  r.has_slack = r.has_qp = true;
  r.trace[0].slack[3] = 0.3;
  r.trace[0].slack[4] = 0.4;
  r.trace[1].slack[0] = -1.5;
  r.trace[2].active_rows = 6;
  r.trace[1].fallback = Fallback::kNoAcceleration;
  r.trace[2].fallback = Fallback::kRelaxed;
  r.trace[2].status = r.trace[1].status = StepStatus::kInfeasible;
  for (int i = 1; i <= 100; ++i) r.step_seconds.push_back(1e-6 * (101 - i));
  r.step_seconds.push_back(0.03);
  const TrialRow row = measure(r, *tiny_robot());
  EXPECT_NEAR(row.slack_mean, 0.5, 1e-12);
  EXPECT_NEAR(row.slack_max, 1.5, 1e-12);
  EXPECT_NEAR(row.active_rows_mean, 1.5, 1e-12);
  EXPECT_EQ(row.qp_infeasible, 2);
  EXPECT_EQ(row.fallback_no_acceleration, 1);
  EXPECT_EQ(row.fallback_relaxed, 1);
  EXPECT_EQ(row.fallback_brake, 0);
  EXPECT_NEAR(row.timing.t_step_median_us, 51, 1e-9);
  EXPECT_NEAR(row.timing.t_step_p99_us, 100, 1e-9);
  EXPECT_NEAR(row.timing.t_step_max_us, 30000, 1e-9);
  EXPECT_EQ(row.timing.deadline_misses, 1);
}

TEST(Metrics, OfPhysicsInDynamicModeAlone) {
  const auto physics = [](double time, PlantState&, PlantReport& report) {
    if (time > 0.05) return;  // the periods that end at 0.02 s and 0.04 s
    report.energy = time > 0.0 ? 1.25 : 0.0;
    report.redone_steps = time > 0.03 ? 3 : 0;
    report.divided_steps = time > 0.01 ? 2 : 0;
  };
  TrialSpec spec = tiny_spec();
  const TrialRow kinematic = run_scripted(spec, tiny_world(0.4), drive(0.5, 0.8), physics).row;
  EXPECT_TRUE(std::isnan(kinematic.energy_j));
  EXPECT_TRUE(std::isnan(kinematic.redone_steps));
  EXPECT_TRUE(std::isnan(kinematic.divided_steps));
  spec.simulation.mode = SimulationMode::kDynamic;
  const TrialRow row = run_scripted(spec, tiny_world(0.4), drive(0.5, 0.8), physics).row;
  EXPECT_EQ(row.energy_j, 2.5);
  EXPECT_EQ(row.redone_steps, 3.0);
  EXPECT_EQ(row.divided_steps, 4.0);
}

TEST(Metrics, AbsentWhereTheyDoNotExist) {
  const TrialRow row = measure(recording(
                                   2, [](double) { return 0.0; }, [](double) { return 0.0; }),
                               *tiny_robot());
  EXPECT_TRUE(std::isnan(row.jerk_ee_rms)) << "three samples have no third difference";
  EXPECT_TRUE(std::isnan(row.slack_mean));
  EXPECT_TRUE(std::isnan(row.active_rows_mean));
  EXPECT_TRUE(std::isnan(row.energy_j));
  EXPECT_TRUE(std::isnan(row.redone_steps));
  EXPECT_TRUE(std::isnan(row.divided_steps));
  EXPECT_TRUE(std::isnan(row.slip_max_m_s));
  EXPECT_TRUE(std::isnan(row.tracking_error_rms));
  EXPECT_TRUE(std::isnan(row.clearance_min_m));
  EXPECT_TRUE(std::isnan(row.collision_time_s));
  const TrialRow nothing = measure({}, *tiny_robot());
  EXPECT_EQ(nothing.steps, 0);
  EXPECT_TRUE(std::isnan(nothing.position_error_m));
}

TEST(Metrics, ClearanceIsExactHoweverFarAndNearestOfAllSamples) {
  // The base passes a sphere 2 m to the side and one 30 m above: 2 - 0.2 - 0.05 at its nearest, at x = 1.
  World world = tiny_world(4.0);
  world.objects = {sphere("high", {0, 0, 30}, 1.0), sphere("side", {1.0, -2.0, 0.1}, 0.2)};
  const TrialOutput out = run_scripted(tiny_spec(), world, drive(0.5, 4.0));
  EXPECT_NEAR(out.row.clearance_min_m, 1.75, 1e-6);
  // Self: "@base" to "slide" is nearer than "upper" to "slide": sqrt(0.6^2 + 0.4^2) - 0.1, and 0.6 - 0.1.
  EXPECT_NEAR(out.row.clearance_self_min_m, 0.5, 1e-6);
}

}  // namespace
}  // namespace moma::test
