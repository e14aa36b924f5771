#pragma once

#include <array>
#include <limits>
#include <string>
#include <string_view>

#include "controller/describe/describe.h"
#include "controller/describe/enumeration.h"
#include "eval/trial/column.h"
#include "eval/trial/sample.h"

namespace moma {

enum class Outcome { kSuccess, kCollision, kTimeout, kStuck, kJointLimit, kTipped, kInfeasible, kDiverged, kError };
constexpr auto words(Of<Outcome>) {
  return std::to_array<std::string_view>(
      {"success", "collision", "timeout", "stuck", "joint_limit", "tipped", "infeasible", "diverged", "error"});
}
static_assert(all_worded<Outcome>());

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

  struct Timing {
    double t_solve_median_us = kAbsent, t_solve_p99_us = kAbsent, t_solve_max_us = kAbsent;
    double t_step_median_us = kAbsent, t_step_p99_us = kAbsent, t_step_max_us = kAbsent;
    double t_trial_us = kAbsent;
    int deadline_misses = 0;
  } timing;
};

template <class Visitor>
constexpr void describe(Visitor& v, Of<TrialRow>) {
  using R = TrialRow;
  using enum Better;
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
           Column{.label = "time to goal",
                  .unit = "s",
                  .better = kLow,
                  .decimals = 2,
                  .null_when = "unless the trial succeeds",
                  .head = "To goal",
                  .text = "start of the dwell at the goal"});
  v.member("position_error_m", &R::position_error_m,
           Column{.label = "final position error",
                  .unit = "m",
                  .better = kLow,
                  .head = "Error",
                  .text = "distance to the goal at the end"});
  v.member("orientation_error_rad", &R::orientation_error_rad,
           Column{.label = "final orientation error",
                  .unit = "rad",
                  .better = kLow,
                  .head = "Error",
                  .text = "angle to the goal at the end"});
  v.member("path_ee_m", &R::path_ee_m,
           Column{.label = "path of the end effector",
                  .unit = "m",
                  .better = kLow,
                  .decimals = 2,
                  .text = "length of the end effector's path"});
  v.member("path_base_m", &R::path_base_m,
           Column{.label = "path of the base",
                  .unit = "m",
                  .better = kLow,
                  .decimals = 2,
                  .text = "length of the base's path in the plane"});
  v.member("manip_mean", &R::manip_mean,
           Column{.label = "manipulability, mean",
                  .better = kHigh,
                  .decimals = 4,
                  .head = "Mean manip.",
                  .summary = true,
                  .text = "translational manipulability, mean over the trial"});
  v.member("manip_min", &R::manip_min,
           Column{.label = "manipulability, least", .better = kHigh, .decimals = 4, .text = "least value"});
  v.member("manip_final", &R::manip_final,
           Column{.label = "manipulability at the end", .better = kHigh, .decimals = 4, .text = "value at the end"});
  v.member("manip_all_mean", &R::manip_all_mean,
           Column{.label = "six-row manipulability, mean",
                  .better = kHigh,
                  .decimals = 4,
                  .text = "manipulability with all six rows, mean over the trial"});
  v.member("manip_all_min", &R::manip_all_min,
           Column{.label = "six-row manipulability, least", .better = kHigh, .decimals = 4, .text = "least value"});
  v.member(
      "manip_all_final", &R::manip_all_final,
      Column{.label = "six-row manipulability at the end", .better = kHigh, .decimals = 4, .text = "value at the end"});
  v.member("clearance_min_m", &R::clearance_min_m,
           Column{.label = "least clearance",
                  .unit = "m",
                  .better = kHigh,
                  .null_when = "in a world without objects",
                  .head = "Clearance",
                  .summary = true,
                  .text = "least distance to an object"});
  v.member("clearance_self_min_m", &R::clearance_self_min_m,
           Column{.label = "least clearance to itself",
                  .unit = "m",
                  .better = kHigh,
                  .text = "least distance of the robot to itself"});
  v.member("limit_margin_min", &R::limit_margin_min,
           Column{.label = "least joint-limit margin",
                  .unit = "rad or m",
                  .better = kHigh,
                  .text = "least distance of a joint to its limit"});
  v.member("collision_count", &R::collision_count,
           Column{.label = "pairs in contact", .better = kLow, .decimals = 0, .text = "pairs in contact at the end"});
  v.member("collision_time_s", &R::collision_time_s,
           Column{.label = "time of collision",
                  .unit = "s",
                  .decimals = 2,
                  .null_when = "unless the trial has a collision",
                  .text = "time of the first contact"});
  v.member("collision_depth_m", &R::collision_depth_m,
           Column{.label = "collision depth",
                  .unit = "m",
                  .better = kLow,
                  .significant = 2,
                  .null_when = "unless the trial has a collision",
                  .text = "depth of the worst contact"});
  v.member("jerk_ee_rms", &R::jerk_ee_rms,
           Column{.label = "jerk of the end effector, RMS",
                  .unit = "m/s³",
                  .better = kLow,
                  .text = "smoothness of the end effector's motion"});
  v.member("jerk_joint_rms", &R::jerk_joint_rms,
           Column{.label = "jerk of the joints, RMS",
                  .unit = "rad/s³",
                  .better = kLow,
                  .text = "smoothness of the joints' motion"});
  v.member("command_change_mean", &R::command_change_mean,
           Column{.label = "command change, mean",
                  .better = kLow,
                  .head = "Change",
                  .summary = true,
                  .text = "mean over steps of the largest |change| / limit"});
  v.member("acceleration_max", &R::acceleration_max,
           Column{.label = "acceleration of the joints, greatest",
                  .unit = "rad/s²",
                  .better = kLow,
                  .earlier = Earlier::kUnknown,
                  .text = "greatest change of a joint's command over the control period"});
  v.member("energy_j", &R::energy_j,
           Column{.label = "energy",
                  .unit = "J",
                  .better = kLow,
                  .null_when = "in kinematic mode",
                  .text = "integral of |torque x speed| over all motors"});
  v.member("slack_mean", &R::slack_mean,
           Column{.label = "slack, mean", .better = kLow, .text = "length of the QP's slack, mean over steps"});
  v.member("slack_max", &R::slack_max, Column{.label = "slack, greatest", .better = kLow, .text = "largest value"});
  v.member(
      "active_rows_mean", &R::active_rows_mean,
      Column{.label = "active constraints, mean", .decimals = 2, .text = "active rows of the QP, mean over steps"});
  v.member(
      "qp_infeasible", &R::qp_infeasible,
      Column{.label = "infeasible steps", .better = kLow, .decimals = 0, .text = "steps whose QP had no solution"});
  v.member("fallback_no_acceleration", &R::fallback_no_acceleration,
           Column{.label = "steps without acceleration bounds",
                  .better = kLow,
                  .decimals = 0,
                  .text = "steps that fell back to a QP without acceleration bounds"});
  v.member("fallback_relaxed", &R::fallback_relaxed,
           Column{.label = "steps with relaxed rows",
                  .better = kLow,
                  .decimals = 0,
                  .text = "steps that fell back to a QP with relaxed rows"});
  v.member("fallback_brake", &R::fallback_brake,
           Column{.label = "braking steps", .better = kLow, .decimals = 0, .text = "steps that could only brake"});
  v.member("slip_max_m_s", &R::slip_max_m_s,
           Column{.label = "wheel slip, greatest",
                  .unit = "m/s",
                  .better = kLow,
                  .text = "greatest slip of a wheel (`dynamic` with wheels only)"});
  v.member("latency_base_s", &R::latency_base_s,
           Column{.label = "latency of the base, as found",
                  .unit = "s",
                  .null_when = "unless the controller identifies it (`prediction.identify`) on a mobile base",
                  .earlier = Earlier::kUnknown,
                  .text = "identified time from a command of the base to the measurement of its velocity"});
  v.member("latency_base_off_s", &R::latency_base_off_s,
           Column{.label = "latency of the base, found less configured",
                  .unit = "s",
                  .null_when = "as latency_base_s",
                  .earlier = Earlier::kUnknown,
                  .text = "difference from the controller's `prediction`"});
  v.member("latency_joints_s", &R::latency_joints_s,
           Column{.label = "latency of the joints, as found",
                  .unit = "s",
                  .null_when = "unless the controller identifies it (`prediction.identify`)",
                  .earlier = Earlier::kUnknown,
                  .text = "the same for the joints"});
  v.member("latency_joints_off_s", &R::latency_joints_off_s,
           Column{.label = "latency of the joints, found less configured",
                  .unit = "s",
                  .null_when = "as latency_joints_s",
                  .earlier = Earlier::kUnknown,
                  .text = "difference from the controller's `prediction`"});
  v.member("separation_margin_min_m", &R::separation_margin_min_m,
           Column{.label = "least margin of the separation",
                  .unit = "m",
                  .better = kHigh,
                  .null_when = "in a world where nothing moves",
                  .earlier = Earlier::kUnknown,
                  .text = "least distance minus protective separation distance, over all moving objects"});
  v.member("tracking_error_rms", &R::tracking_error_rms,
           Column{.label = "tracking error, RMS",
                  .unit = "m",
                  .better = kLow,
                  .text = "root mean square of the distance to a moving goal"});
  v.member("lcp_messages", &R::lcp_messages,
           Column{.label = "messages of the physics solver",
                  .better = kLow,
                  .decimals = 0,
                  .text = "warnings of ODE's contact solver"});
  v.member("redone_steps", &R::redone_steps,
           Column{.label = "physics steps at a motor's limit",
                  .better = kLow,
                  .decimals = 0,
                  .null_when = "in kinematic mode",
                  .earlier = Earlier::kUnknown,
                  .text = "physics steps repeated because a motor exceeded its limit"});
  v.member("divided_steps", &R::divided_steps,
           Column{.label = "physics steps divided near contact",
                  .decimals = 0,
                  .null_when = "in kinematic mode",
                  .earlier = Earlier::kUnknown,
                  .text = "physics steps divided because of possible contacts"});
  v.member("steps", &R::steps, Column{.label = "control steps", .decimals = 0, .text = "control steps"});
  v.member("detector_checks", &R::detector_checks,
           Column{.label = "states in which contacts were cross-checked",
                  .decimals = 0,
                  .earlier = Earlier::kZero,
                  .text = "states in which ODE's contacts were compared with the distance library's"});
  v.member("detector_disagreements", &R::detector_disagreements,
           Column{.label = "disagreements of the contact detectors",
                  .better = kLow,
                  .decimals = 0,
                  .earlier = Earlier::kZero,
                  .text = "pairs in these states that touch for one detector alone"});
  v.member("detector_deepest_m", &R::detector_deepest_m,
           Column{.label = "deepest disagreement of the contact detectors",
                  .unit = "m",
                  .better = kLow,
                  .decimals = 6,
                  .earlier = Earlier::kZero,
                  .text = "largest depth of such a pair"});
  v.inlined(&R::timing);
}

template <class Visitor>
constexpr void describe(Visitor& v, Of<TrialRow::Timing>) {
  using T = TrialRow::Timing;
  using enum Better;
  v.member("t_solve_median_us", &T::t_solve_median_us,
           Column{.label = "QP solution, median",
                  .unit = "µs",
                  .better = kLow,
                  .decimals = 1,
                  .text = "time of the QP's solution in a step, median"});
  v.member("t_solve_p99_us", &T::t_solve_p99_us,
           Column{.label = "QP solution, 99th percentile",
                  .unit = "µs",
                  .better = kLow,
                  .decimals = 1,
                  .text = "99th percentile"});
  v.member(
      "t_solve_max_us", &T::t_solve_max_us,
      Column{.label = "QP solution, longest", .unit = "µs", .better = kLow, .decimals = 1, .text = "longest time"});
  v.member("t_step_median_us", &T::t_step_median_us,
           Column{.label = "control step, median",
                  .unit = "µs",
                  .better = kLow,
                  .decimals = 1,
                  .text = "time of a whole control step, median"});
  v.member("t_step_p99_us", &T::t_step_p99_us,
           Column{.label = "control step, 99th percentile",
                  .unit = "µs",
                  .better = kLow,
                  .decimals = 1,
                  .head = "Step p99",
                  .text = "its 99th percentile"});
  v.member(
      "t_step_max_us", &T::t_step_max_us,
      Column{.label = "control step, longest", .unit = "µs", .better = kLow, .decimals = 1, .text = "longest time"});
  v.member("t_trial_us", &T::t_trial_us,
           Column{.label = "whole trial, wall time",
                  .unit = "µs",
                  .better = kLow,
                  .decimals = 0,
                  .text = "wall time of the whole trial"});
  v.member("deadline_misses", &T::deadline_misses,
           Column{.label = "deadline misses",
                  .better = kLow,
                  .decimals = 0,
                  .in_view = false,
                  .text = "steps longer than the control period"});
}

}  // namespace moma
