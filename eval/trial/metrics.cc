#include "eval/trial/metrics.h"

#include <algorithm>
#include <cmath>

#include "controller/describe/complete.h"
#include "controller/params.h"

namespace moma {

static_assert(is_complete<TrialRow>(), "a member of TrialRow without its line in describe()");
static_assert(is_complete<TrialRow::Timing>(), "a member of TrialRow::Timing without its line in describe()");
static_assert(is_complete<Sample>(), "a member of Sample without its line in describe()");
static_assert(is_complete<EscapeState>(), "a member of EscapeState without its line in describe()");

namespace {

// Returns the quantile at `fraction` (nearest rank). Sorts in place.
double quantile(std::vector<double>& values, double fraction) {
  const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

void time_summary(std::vector<double> seconds, double& median_us, double& p99_us, double& max_us) {
  if (seconds.empty()) return;
  median_us = 1e6 * quantile(seconds, 0.5);
  p99_us = 1e6 * quantile(seconds, 0.99);
  max_us = 1e6 * *std::ranges::max_element(seconds);
}

void measure_states(const Recording& r, TrialRow& row) {
  if (r.states.empty()) return;
  double manip_sum = 0.0, manip_all_sum = 0.0, square_sum = 0.0;
  double manip_min = kInfinity, manip_all_min = kInfinity;
  for (std::size_t k = 0; k < r.states.size(); ++k) {
    const StateRecord& s = r.states[k];
    manip_sum += s.manipulability;
    manip_all_sum += s.manipulability_all;
    manip_min = std::min(manip_min, s.manipulability);
    manip_all_min = std::min(manip_all_min, s.manipulability_all);
    square_sum += s.position_error * s.position_error;
    if (k > 0) row.path_ee_m += (s.p_WE - r.states[k - 1].p_WE).norm();
  }
  const auto n = static_cast<double>(r.states.size());
  const StateRecord& last = r.states.back();
  row.position_error_m = last.position_error;
  row.orientation_error_rad = last.orientation_error;
  row.manip_mean = manip_sum / n;
  row.manip_min = manip_min;
  row.manip_final = last.manipulability;
  row.manip_all_mean = manip_all_sum / n;
  row.manip_all_min = manip_all_min;
  row.manip_all_final = last.manipulability_all;
  if (r.moving_goal) row.tracking_error_rms = std::sqrt(square_sum / n);
}

void measure_configurations(const Recording& r, const RobotModel& model, TrialRow& row) {
  const std::size_t n = r.states.size();
  const auto q = [&](std::size_t k) -> const VectorX& { return k < r.trace.size() ? r.trace[k].q : r.last.q; };
  const auto base = [&](std::size_t k) -> const Vector3& { return k < r.trace.size() ? r.trace[k].base : r.last.base; };

  double margin = kInfinity;
  for (std::size_t k = 0; k < n; ++k) {
    for (int i = 0; i < model.num_joints(); ++i) {
      const ControlledJoint& joint = model.joint(i);
      margin = std::min({margin, q(k)[i] - joint.lower, joint.upper - q(k)[i]});
    }
    if (k > 0) row.path_base_m += (base(k) - base(k - 1)).head<2>().norm();
  }
  if (std::isfinite(margin)) row.limit_margin_min = margin;

  if (n < 4) return;
  const double cube = r.control_period * r.control_period * r.control_period;
  double ee = 0.0, joints = 0.0;
  for (std::size_t k = 0; k + 3 < n; ++k) {
    const auto& s = r.states;
    ee += (s[k + 3].p_WE - 3.0 * s[k + 2].p_WE + 3.0 * s[k + 1].p_WE - s[k].p_WE).squaredNorm();
    joints += (q(k + 3) - 3.0 * q(k + 2) + 3.0 * q(k + 1) - q(k)).squaredNorm();
  }
  row.jerk_ee_rms = std::sqrt(ee / static_cast<double>(n - 3)) / cube;
  row.jerk_joint_rms = std::sqrt(joints / static_cast<double>(n - 3)) / cube;
}

void measure_steps(const Recording& r, const RobotModel& model, TrialRow& row) {
  row.steps = static_cast<int>(r.trace.size());
  if (r.trace.empty()) return;
  const VectorX limits = model.velocity_limits();
  double change_sum = 0.0, slack_sum = 0.0, slack_max = 0.0, active_sum = 0.0, acceleration = 0.0;
  for (std::size_t k = 0; k < r.trace.size(); ++k) {
    const Sample& s = r.trace[k];
    const double slack = s.slack.norm();
    slack_sum += slack;
    slack_max = std::max(slack_max, slack);
    active_sum += s.active_rows;
    row.qp_infeasible += s.status == StepStatus::kInfeasible ? 1 : 0;
    row.fallback_no_acceleration += s.fallback == Fallback::kNoAcceleration ? 1 : 0;
    row.fallback_relaxed += s.fallback == Fallback::kRelaxed ? 1 : 0;
    row.fallback_brake += s.fallback == Fallback::kBrake ? 1 : 0;
    if (k == 0) continue;
    double change = 0.0;
    for (Eigen::Index i = 0; i < s.command.size(); ++i)
      if (limits[i] > 0.0) change = std::max(change, std::abs(s.command[i] - r.trace[k - 1].command[i]) / limits[i]);
    change_sum += change;
    const auto& before = r.trace[k - 1].command;
    for (Eigen::Index i = model.base_dof(); i < s.command.size(); ++i)
      acceleration = std::max(acceleration, std::abs(s.command[i] - before[i]) / r.control_period);
  }
  const auto n = static_cast<double>(r.trace.size());
  if (r.trace.size() > 1) {
    row.command_change_mean = change_sum / (n - 1.0);
    row.acceleration_max = acceleration;
  }
  if (r.has_slack) {
    row.slack_mean = slack_sum / n;
    row.slack_max = slack_max;
  }
  if (r.has_qp) row.active_rows_mean = active_sum / n;
}

// Returns the phase of a control period. `share` is the largest ratio of a command to its limit, `before` the one of
// the previous period.
double TrialRow::*phase_of(const Recording& r, const StateRecord& s, double share, double before) {
  constexpr double kClose = 0.05;     // [m]
  constexpr double kStanding = 0.02;  // share of a limit
  constexpr double kChanging = 0.2;   // change of the share [1/s]
  if (s.position_error < r.success.position)
    return s.orientation_error < r.success.orientation ? &TrialRow::phase_dwell_s : &TrialRow::phase_turning_s;
  if (s.position_error < kClose) return &TrialRow::phase_last_5_cm_s;
  if (share < kStanding) return &TrialRow::phase_standing_s;
  const double change = (share - before) / r.control_period;
  if (change > kChanging) return &TrialRow::phase_speeding_up_s;
  return change < -kChanging ? &TrialRow::phase_slowing_down_s : &TrialRow::phase_cruise_s;
}

void measure_phases(const Recording& r, const RobotModel& model, TrialRow& row) {
  if (r.trace.empty()) return;
  for (auto phase : {&TrialRow::phase_standing_s, &TrialRow::phase_speeding_up_s, &TrialRow::phase_cruise_s,
                     &TrialRow::phase_slowing_down_s, &TrialRow::phase_last_5_cm_s, &TrialRow::phase_turning_s,
                     &TrialRow::phase_dwell_s})
    row.*phase = 0.0;
  const VectorX limits = model.velocity_limits();
  double before = 0.0;
  for (std::size_t k = 0; k < r.trace.size(); ++k) {
    double share = 0.0;
    for (Eigen::Index i = 0; i < limits.size(); ++i)
      if (limits[i] > 0.0) share = std::max(share, std::abs(r.trace[k].command[i]) / limits[i]);
    row.*phase_of(r, r.states[k], share, before) += r.control_period;
    before = share;
  }
}

}  // namespace

TrialRow measure(const Recording& r, const RobotModel& model) {
  TrialRow row = r.row;
  measure_states(r, row);
  measure_configurations(r, model, row);
  measure_steps(r, model, row);
  measure_phases(r, model, row);
  TrialRow::Timing& timing = row.timing;
  time_summary(r.step_seconds, timing.t_step_median_us, timing.t_step_p99_us, timing.t_step_max_us);
  time_summary(r.solve_seconds, timing.t_solve_median_us, timing.t_solve_p99_us, timing.t_solve_max_us);
  timing.deadline_misses =
      static_cast<int>(std::ranges::count_if(r.step_seconds, [&](double s) { return s > r.control_period; }));
  return row;
}

}  // namespace moma
