#pragma once

#include <array>
#include <limits>
#include <string>
#include <string_view>

#include "controller/describe/column.h"
#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"
#include "eval/trial/sample.h"

namespace moma {

enum class Outcome {
  kSuccess,
  kCollision,
  kTimeout,
  kStuck,
  kJointLimit,
  kTipped,
  kInfeasible,
  kDiverged,
  kSpilled,
  kError
};
constexpr auto words(Of<Outcome>) {
  return std::to_array<std::string_view>({"success", "collision", "timeout", "stuck", "joint_limit", "tipped",
                                          "infeasible", "diverged", "spilled", "error"});
}

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();  // NULL in the store

/// Metrics of one trial; units in the names, as in v_trials. NaN is NULL. All but `timing` are deterministic. A new
/// metric is a member here, its line in the description below, and its measurement in metrics.cc; with
/// Earlier::kUnknown stored trials keep their keys and are not computed again.
struct TrialRow {
  Outcome outcome = Outcome::kError;
  std::string reason;  ///< for a person; for kError the exception's text
  std::string link;    ///< robot shape's link in contact, collision only
  std::string object;  ///< object's name, "floor", or "self:LINK"
  double time_end_s = 0.0;
  double time_to_goal_s = kAbsent;
  double position_error_m = kAbsent;
  double orientation_error_rad = kAbsent;
  double path_ee_m = 0.0;
  double path_base_m = 0.0;
  double manip_mean = kAbsent, manip_min = kAbsent, manip_final = kAbsent;
  double manip_all_mean = kAbsent, manip_all_min = kAbsent, manip_all_final = kAbsent;
  double clearance_min_m = kAbsent;
  double clearance_self_min_m = kAbsent;
  double limit_margin_min = kAbsent;
  int collision_count = 0;
  double collision_time_s = kAbsent;
  double collision_depth_m = kAbsent;
  double jerk_ee_rms = kAbsent;
  double jerk_joint_rms = kAbsent;
  double command_change_mean = kAbsent;
  double time_bound_s = kAbsent;
  double times_bound = kAbsent;
  double acceleration_max = kAbsent;
  double energy_j = kAbsent;
  double slack_mean = kAbsent;
  double slack_max = kAbsent;
  double active_rows_mean = kAbsent;
  int qp_infeasible = 0;
  int fallback_no_acceleration = 0;
  int fallback_relaxed = 0;
  int fallback_brake = 0;
  double slip_max_m_s = kAbsent;
  double latency_base_s = kAbsent;      ///< as identified, from a command to the measurement of its velocity
  double latency_base_off_s = kAbsent;  ///< identified minus configured
  double latency_joints_s = kAbsent;
  double latency_joints_off_s = kAbsent;
  double separation_margin_min_m = kAbsent;
  double tracking_error_rms = kAbsent;
  int lcp_messages = 0;
  double redone_steps = kAbsent;   ///< physics steps repeated with the motors' limits
  double divided_steps = kAbsent;  ///< physics steps divided because of possible contacts
  int steps = 0;
  int detector_checks = 0;              ///< states in which the two contact detectors were compared
  int detector_disagreements = 0;       ///< pairs in them that touch for one detector alone
  double detector_deepest_m = kAbsent;  ///< the largest of these
  double goals_reached = kAbsent;
  std::string goals;  ///< JSON: for each reached goal time_s and clearance_m
  double phase_standing_s = kAbsent, phase_speeding_up_s = kAbsent, phase_cruise_s = kAbsent,
         phase_slowing_down_s = kAbsent, phase_last_5_cm_s = kAbsent, phase_turning_s = kAbsent,
         phase_dwell_s = kAbsent;  ///< Phases of the trial; their sum is its time
  double tilt_max_rad = kAbsent;   ///< of the tool's axis, in a world that asks for an upright tool

  struct Timing {
    double t_solve_median_us = kAbsent, t_solve_p99_us = kAbsent, t_solve_max_us = kAbsent;
    double t_step_median_us = kAbsent, t_step_p99_us = kAbsent, t_step_max_us = kAbsent;
    double t_trial_us = kAbsent;
    int deadline_misses = 0;
  } timing;
};

constexpr void describe(auto& v, Of<TrialRow>) {
  using R = TrialRow;
  using enum Better;
  using enum Earlier;
  const auto later = [&v](auto name, auto member, const Column& about) {
    v.member(name, member, about.since(kUnknown));
  };
  v.member("outcome", &R::outcome, Column{.text = "end of the trial"});
  v.member("reason", &R::reason, Column{.text = "description for a person; the exception's text for `error`"});
  v.member("link", &R::link, Column{.text = "link of the robot in contact (`collision` only)"});
  v.member("object", &R::object, Column{.text = "touched object's name, `floor` or `self:LINK` (`collision` only)"});
  v.member("time_end_s", &R::time_end_s,
           Column{.label = "end of the trial",
                  .unit = "s",
                  .decimals = 2,
                  .always = true,
                  .text = "simulated time of the end"});
  v.member("time_to_goal_s", &R::time_to_goal_s,
           metric("time to goal", "s", kLow, "start of the dwell at the goal")
               .with_decimals(2)
               .absent("unless the trial succeeds")
               .in_table("To goal")
               .shown_as({.place = 1,
                          .summary = "median time to goal s",
                          .median = "time_to_goal_median_s",
                          .compared = true,
                          .judged = true}));
  v.member("position_error_m", &R::position_error_m,
           metric("final position error", "m", kLow, "distance to the goal at the end").in_table("Error"));
  v.member("orientation_error_rad", &R::orientation_error_rad,
           metric("final orientation error", "rad", kLow, "angle to the goal at the end").in_table("Error"));
  v.member("path_ee_m", &R::path_ee_m,
           metric("path of the end effector", "m", kLow, "length of the end effector's path")
               .with_decimals(2)
               .shown_as({.place = 6, .compared = true}));
  v.member("path_base_m", &R::path_base_m,
           metric("path of the base", "m", kLow, "length of the base's path in the plane")
               .with_decimals(2)
               .shown_as({.place = 7, .compared = true}));
  v.member("manip_mean", &R::manip_mean,
           metric("manipulability, mean", "", kHigh, "translational manipulability, mean over the trial")
               .with_decimals(4)
               .in_table("Mean manip.")
               .shown_as({.place = 3, .summary = "mean manip.", .compared = true, .judged = true}));
  v.member("manip_min", &R::manip_min, metric("manipulability, least", "", kHigh, "least value").with_decimals(4));
  v.member("manip_final", &R::manip_final,
           metric("manipulability at the end", "", kHigh, "value at the end").with_decimals(4));
  v.member("manip_all_mean", &R::manip_all_mean,
           metric("six-row manipulability, mean", "", kHigh, "manipulability with all six rows, mean over the trial")
               .with_decimals(4));
  v.member("manip_all_min", &R::manip_all_min,
           metric("six-row manipulability, least", "", kHigh, "least value").with_decimals(4));
  v.member("manip_all_final", &R::manip_all_final,
           metric("six-row manipulability at the end", "", kHigh, "value at the end").with_decimals(4));
  v.member("clearance_min_m", &R::clearance_min_m,
           metric("least clearance", "m", kHigh, "least distance to an object")
               .absent("in a world without objects")
               .in_table("Clearance")
               .shown_as({.place = 4, .summary = "mean least clearance m", .compared = true}));
  v.member("clearance_self_min_m", &R::clearance_self_min_m,
           metric("least clearance to itself", "m", kHigh, "least distance of the robot to itself"));
  v.member("limit_margin_min", &R::limit_margin_min,
           metric("least joint-limit margin", "rad or m", kHigh, "least distance of a joint to its limit"));
  v.member("collision_count", &R::collision_count,
           count_metric("pairs in contact", kLow, "pairs in contact at the end"));
  v.member("collision_time_s", &R::collision_time_s,
           metric("time of collision", "s", kNeither, "time of the first contact")
               .with_decimals(2)
               .absent("unless the trial has a collision"));
  v.member("collision_depth_m", &R::collision_depth_m,
           Column{.label = "collision depth",
                  .unit = "m",
                  .better = kLow,
                  .significant = 2,
                  .null_when = "unless the trial has a collision",
                  .text = "depth of the worst contact"});
  v.member("jerk_ee_rms", &R::jerk_ee_rms,
           metric("jerk of the end effector, RMS", "m/s³", kLow, "smoothness of the end effector's motion")
               .shown_as({.place = 8, .compared = true}));
  v.member("jerk_joint_rms", &R::jerk_joint_rms,
           metric("jerk of the joints, RMS", "rad/s³", kLow, "smoothness of the joints' motion"));
  v.member("command_change_mean", &R::command_change_mean,
           metric("command change, mean", "", kLow, "mean over steps of the largest |change| / limit")
               .in_table("Change")
               .shown_as({.place = 5, .summary = "mean change", .compared = true, .judged = true}));
  later("time_bound_s", &R::time_bound_s,
        metric("time bound", "s", kNeither,
               "least time found from rest to rest at the goal for the robot alone, without objects and controller")
            .with_decimals(2)
            .absent("unless the world has one fixed pose as its goal"));
  later("times_bound", &R::times_bound,
        metric("times the bound, mean", "", kLow, "time_to_goal_s / time_bound_s")
            .with_decimals(2)
            .absent("unless the trial succeeds and has a time bound")
            .in_table("x bound")
            .shown_as({.place = 2, .summary = "mean times bound"}));
  later("acceleration_max", &R::acceleration_max,
        metric("acceleration of the joints, greatest", "rad/s²", kLow,
               "greatest change of a joint's command over the control period"));
  v.member("energy_j", &R::energy_j,
           metric("energy", "J", kLow, "integral of |torque x speed| over all motors").absent("in kinematic mode"));
  v.member("slack_mean", &R::slack_mean, metric("slack, mean", "", kLow, "length of the QP's slack, mean over steps"));
  v.member("slack_max", &R::slack_max, metric("slack, greatest", "", kLow, "largest value"));
  v.member("active_rows_mean", &R::active_rows_mean,
           metric("active constraints, mean", "", kNeither, "active rows of the QP, mean over steps").with_decimals(2));
  v.member("qp_infeasible", &R::qp_infeasible,
           count_metric("infeasible steps", kLow, "steps whose QP had no solution"));
  v.member("fallback_no_acceleration", &R::fallback_no_acceleration,
           count_metric("steps without acceleration bounds", kLow,
                        "steps that fell back to a QP without acceleration bounds"));
  v.member("fallback_relaxed", &R::fallback_relaxed,
           count_metric("steps with relaxed rows", kLow, "steps that fell back to a QP with relaxed rows"));
  v.member("fallback_brake", &R::fallback_brake, count_metric("braking steps", kLow, "steps that could only brake"));
  v.member("slip_max_m_s", &R::slip_max_m_s,
           metric("wheel slip, greatest", "m/s", kLow, "greatest slip of a wheel (`dynamic` with wheels only)"));
  later("latency_base_s", &R::latency_base_s,
        metric("latency of the base, as found", "s", kNeither,
               "identified time from a command of the base to the measurement of its velocity")
            .absent("unless the controller identifies it (`prediction.identify`) on a mobile base"));
  later("latency_base_off_s", &R::latency_base_off_s,
        metric("latency of the base, found less configured", "s", kNeither,
               "difference from the controller's `prediction`")
            .absent("as latency_base_s"));
  later("latency_joints_s", &R::latency_joints_s,
        metric("latency of the joints, as found", "s", kNeither, "the same for the joints")
            .absent("unless the controller identifies it (`prediction.identify`)"));
  later("latency_joints_off_s", &R::latency_joints_off_s,
        metric("latency of the joints, found less configured", "s", kNeither,
               "difference from the controller's `prediction`")
            .absent("as latency_joints_s"));
  later("separation_margin_min_m", &R::separation_margin_min_m,
        metric("least margin of the separation", "m", kHigh,
               "least distance minus protective separation distance, over all moving objects")
            .absent("in a world where nothing moves"));
  v.member("tracking_error_rms", &R::tracking_error_rms,
           metric("tracking error, RMS", "m", kLow, "root mean square of the distance to a moving goal"));
  v.member("lcp_messages", &R::lcp_messages,
           count_metric("messages of the physics solver", kLow, "warnings of ODE's contact solver"));
  later("redone_steps", &R::redone_steps,
        count_metric("physics steps at a motor's limit", kLow,
                     "physics steps repeated because a motor exceeded its limit")
            .absent("in kinematic mode"));
  later(
      "divided_steps", &R::divided_steps,
      count_metric("physics steps divided near contact", kNeither, "physics steps divided because of possible contacts")
          .absent("in kinematic mode"));
  v.member("steps", &R::steps, count_metric("control steps", kNeither, "control steps"));
  v.member("detector_checks", &R::detector_checks,
           count_metric("states in which contacts were cross-checked", kNeither,
                        "states in which ODE's contacts were compared with the distance library's")
               .since(kZero));
  v.member("detector_disagreements", &R::detector_disagreements,
           count_metric("disagreements of the contact detectors", kLow,
                        "pairs in these states that touch for one detector alone")
               .since(kZero));
  v.member("detector_deepest_m", &R::detector_deepest_m,
           metric("deepest disagreement of the contact detectors", "m", kLow, "largest depth of such a pair")
               .with_decimals(6)
               .since(kZero));
  later("goals_reached", &R::goals_reached,
        count_metric("goals reached", kHigh, "number of goals reached").absent("in a world of one goal"));
  v.member("goals", &R::goals,
           Column{.earlier = kUnknown,
                  .text = "JSON, for each goal reached: `time_s` of its start of the dwell, `clearance_m` on the way "
                          "there; NULL in a world of one goal. v_goals has a row for each"});
  const auto phase = [&v](auto name, auto member, std::string_view label, std::string_view text) {
    v.member(name, member, metric(label, "s", kNeither, text).with_decimals(2).since(kUnknown));
  };
  phase("phase_standing_s", &R::phase_standing_s, "time standing",
        "time with no coordinate of the command above 2 % of its limit, farther than 5 cm from the goal");
  phase("phase_speeding_up_s", &R::phase_speeding_up_s, "time speeding up",
        "time in which the largest |command| / limit grows by more than 0.2 1/s, farther than 5 cm from the goal");
  phase("phase_cruise_s", &R::phase_cruise_s, "time at cruise", "time in which it stays, farther than 5 cm away");
  phase("phase_slowing_down_s", &R::phase_slowing_down_s, "time slowing down",
        "time in which it falls by more than 0.2 1/s, farther than 5 cm away");
  phase("phase_last_5_cm_s", &R::phase_last_5_cm_s, "time within 5 cm",
        "time from 5 cm to within the tolerance of the position");
  phase("phase_turning_s", &R::phase_turning_s, "time turning",
        "time within the tolerance of the position and beyond that of the orientation");
  phase("phase_dwell_s", &R::phase_dwell_s, "time within tolerance", "time within both tolerances");
  later("tilt_max_rad", &R::tilt_max_rad,
        metric("tilt of the tool, greatest", "rad", kLow, "greatest angle between the tool's axis and the vertical")
            .absent("unless the world asks for an upright tool"));
  v.inlined(&R::timing);
}

constexpr void describe(auto& v, Of<TrialRow::Timing>) {
  using T = TrialRow::Timing;
  using enum Better;
  v.member("t_solve_median_us", &T::t_solve_median_us,
           microseconds("QP solution, median", "time of the QP's solution in a step, median"));
  v.member("t_solve_p99_us", &T::t_solve_p99_us, microseconds("QP solution, 99th percentile", "99th percentile"));
  v.member("t_solve_max_us", &T::t_solve_max_us, microseconds("QP solution, longest", "longest time"));
  v.member("t_step_median_us", &T::t_step_median_us,
           microseconds("control step, median", "time of a whole control step, median"));
  v.member("t_step_p99_us", &T::t_step_p99_us,
           microseconds("control step, 99th percentile", "its 99th percentile").in_table("Step p99"));
  v.member("t_step_max_us", &T::t_step_max_us, microseconds("control step, longest", "longest time"));
  v.member("t_trial_us", &T::t_trial_us,
           metric("whole trial, wall time", "µs", kLow, "wall time of the whole trial").with_decimals(0));
  v.member("deadline_misses", &T::deadline_misses,
           Column{.label = "deadline misses",
                  .better = kLow,
                  .decimals = 0,
                  .in_view = false,
                  .text = "steps longer than the control period"});
}

}  // namespace moma
