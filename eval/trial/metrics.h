#pragma once

#include <vector>

#include "controller/model/robot_model.h"
#include "eval/trial/row.h"
#include "world/plant/plant.h"

namespace moma {

/// What is measured of the true state at each control sample, the last one (after which no command came) included.
struct StateRecord {
  Vector3 p_WE = Vector3::Zero();   ///< end effector [m]
  double position_error = 0.0;      ///< |e_p| [m]
  double orientation_error = 0.0;   ///< |e_R| [rad]
  double l1_error = 0.0;            ///< where the rule of success asks for it [m + rad]
  double manipulability = 0.0;      ///< translation rows
  double manipulability_all = 0.0;  ///< all six rows
};

/// A trial as recorded by the clock: the trace, and what the trace does not hold.
struct Recording {
  double control_period = 0.02;     ///< [s]
  Trace trace;                      ///< one sample per control step
  std::vector<StateRecord> states;  ///< trace.size() + 1; trace.size() where the last state was not finite
  PlantState last;                  ///< the last finite state
  double clearance = kAbsent;       ///< least signed distance to an object at any sample [m]
  double clearance_self = kAbsent;  ///< least signed distance between links at any sample [m]
  std::vector<Contact> contacts;    ///< those that ended the trial
  bool moving_goal = false;
  bool has_slack = false;  ///< the controller has slack variables
  bool has_qp = false;
  bool has_prediction = false;        ///< of moma's own controllers: it knows of latencies
  double latency_base = kAbsent;      ///< as the controller found it from the motion [s]
  double latency_base_off = kAbsent;  ///< that, less what it was told
  double latency_joints = kAbsent;
  double latency_joints_off = kAbsent;
  double separation = kAbsent;  ///< least margin to what moves (separation.h) [m]
  bool has_wheels = false;      ///< dynamic mode on a mobile base
  bool dynamic = false;
  double slip_max = 0.0;  ///< [m/s]
  double energy = 0.0;    ///< [J]
  int lcp_messages = 0;
  int redone_steps = 0;
  int divided_steps = 0;
  int detector_checks = 0;
  DetectorCheck detectors;            ///< all disagreements together
  std::vector<double> step_seconds;   ///< time of each controller step
  std::vector<double> solve_seconds;  ///< time of each solve, where the controller tells; else empty
};

/// All metrics of a row but outcome, reason, link, object, time_end_s, time_to_goal_s. A pure function.
/// - path_ee_m, path_base_m: sums of straight distances between samples (the base's in the plane).
/// - manip_*: over all samples, the last one included.
/// - clearance_*: exact, at every sample, without a limit of range. NULL without objects (without self pairs).
/// - limit_margin_min: least distance of a joint to its nearer limit [rad or m] at any sample; NULL where no joint
///   has limits. Negative beyond a limit.
/// - jerk_ee_rms [m/s^3], jerk_joint_rms [rad/s^3, m/s^3 for prismatic joints]: root of the mean square over the
///   trial of |third difference of positions| / dt^3, the joints' as one vector. NULL with fewer than 4 samples.
/// - command_change_mean: mean over steps, from the second on, of the largest |change of a command's coordinate| /
///   its velocity limit. NULL with fewer than 2 steps.
/// - acceleration_max [rad/s^2, m/s^2 for prismatic joints]: the largest |change of a joint's command| over the control
///   period, of all joints and steps from the second on. NULL with fewer than 2 steps.
/// - slack_mean, slack_max: of |delta| over steps. NULL without slack. active_rows_mean: NULL without a QP.
/// - tracking_error_rms [m]: root mean square of |e_p| over all samples; only for a goal that moves.
/// - latency_*, separation_margin_min_m: as recorded.
/// - detector_deepest_m: NULL without a disagreement.
/// - energy_j: dynamic mode only; slip_max_m_s: there with wheels only.
TrialRow measure(const Recording& recording, const RobotModel& model);

}  // namespace moma
