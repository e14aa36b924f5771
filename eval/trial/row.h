#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "controller/step.h"
#include "world/plant/plant.h"

namespace moma {

enum class Outcome { kSuccess, kCollision, kTimeout, kStuck, kJointLimit, kTipped, kInfeasible, kDiverged, kError };
/// success, collision, timeout, stuck, joint_limit, tipped, infeasible, diverged, error.
std::string_view to_string(Outcome outcome) noexcept;

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();  // NULL in the store

/// Metrics of one trial; units in the names, as in v_trials. NaN is NULL. All but `timing` are deterministic.
struct TrialRow {
  Outcome outcome = Outcome::kError;
  std::string reason;  ///< for a person; the exception's text for kError
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
  double energy_j = kAbsent;
  double slack_mean = kAbsent;
  double slack_max = kAbsent;
  double active_rows_mean = kAbsent;
  int qp_infeasible = 0;
  int fallback_no_acceleration = 0;
  int fallback_relaxed = 0;
  int fallback_brake = 0;
  double slip_max_m_s = kAbsent;
  double tracking_error_rms = kAbsent;
  int lcp_messages = 0;
  int steps = 0;
  int detector_checks = 0;              ///< states in which the two detectors of contact were compared
  int detector_disagreements = 0;       ///< pairs in them that touch by one of the two alone
  double detector_deepest_m = kAbsent;  ///< the worst of these

  struct Timing {
    double t_solve_median_us = kAbsent, t_solve_p99_us = kAbsent, t_solve_max_us = kAbsent;
    double t_step_median_us = kAbsent, t_step_p99_us = kAbsent, t_step_max_us = kAbsent;
    int deadline_misses = 0;
    double t_trial_us = kAbsent;
  } timing;
};

/// One control step's record, the state *before* the step's command acts.
struct Sample {
  double t = 0.0;
  Vector3 base = Vector3::Zero();
  VectorX q;
  VectorX qdot;  ///< measured
  VectorX command;
  Vector6 error = Vector6::Zero();  ///< true error [e_R; e_p]
  Vector6 slack = Vector6::Zero();
  double manipulability = 0.0;
  double least_distance = std::numeric_limits<double>::infinity();
  StepStatus status = StepStatus::kSolved;
  Fallback fallback = Fallback::kNone;
  int active_rows = 0;
  EscapeState escape;  ///< what the controller remembered when the step began
};

using Trace = std::vector<Sample>;

}  // namespace moma
