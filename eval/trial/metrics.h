#pragma once

#include <vector>

#include "controller/model/robot_model.h"
#include "eval/trial/row.h"
#include "eval/trial/spec.h"
#include "world/plant/plant.h"

namespace moma {

/// Measurements of the true state at each control sample, including the last one, which has no command.
struct StateRecord {
  Vector3 p_WE = Vector3::Zero();   ///< end effector [m]
  double position_error = 0.0;      ///< |e_p| [m]
  double orientation_error = 0.0;   ///< |e_R| [rad]
  double l1_error = 0.0;            ///< only if the success rule has this error [m + rad]
  double manipulability = 0.0;      ///< translation rows
  double manipulability_all = 0.0;  ///< all six rows
};

/// The recording of a trial: the trace, and what is measured while it runs.
struct Recording {
  TrialRow row;                     ///< metrics that no trace shows: clearances, contacts, physics, latencies
  double control_period = 0.02;     ///< [s]
  SuccessRule success;              ///< tolerances
  Trace trace;                      ///< one sample per control step
  std::vector<StateRecord> states;  ///< trace.size() + 1; trace.size() if the last state was not finite
  PlantState last;                  ///< the last finite state
  bool moving_goal = false;
  bool has_slack = false;  ///< the controller has slack variables
  bool has_qp = false;
  bool has_prediction = false;        ///< one of moma's own controllers, which knows latencies
  std::vector<double> step_seconds;   ///< time of each controller step
  std::vector<double> solve_seconds;  ///< time of each solve, if the controller measures it; else empty
};

/// Completes recording.row by all metrics of states, steps and times. A pure function.
/// - path_ee_m, path_base_m: sums of straight distances between samples (the base's in the plane).
/// - manip_*: over all samples, the last one included.
/// - limit_margin_min: least distance of a joint to its nearer limit [rad or m] at any sample; NULL where no joint
///   has limits. Negative beyond a limit.
/// - jerk_ee_rms [m/s^3], jerk_joint_rms [rad/s^3, m/s^3 for prismatic joints]: root of the mean square over the
///   trial of |third difference of positions| / dt^3, the joints' as one vector. NULL with fewer than 4 samples.
/// - command_change_mean: mean over steps, from the second on, of the largest |change of a command's coordinate| /
///   its velocity limit. NULL with fewer than 2 steps.
/// - acceleration_max [rad/s^2, m/s^2 for prismatic joints]: the largest |change of a joint's command| over the control
///   period, of all joints and steps from the second on. NULL with fewer than 2 steps.
/// - slack_mean, slack_max: of |delta| over steps. NULL without slack. active_rows_mean: NULL without a QP.
/// - phase_*_s [s]: each control period counts for the first of these that holds at its beginning: dwell, turning,
///   last_5_cm, standing, speeding_up, slowing_down, cruise (row.h has their conditions).
/// - tracking_error_rms [m]: root mean square of |e_p| over all samples; only for a goal that moves.
TrialRow measure(const Recording& recording, const RobotModel& model);

}  // namespace moma
