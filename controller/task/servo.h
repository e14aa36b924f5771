#pragma once

#include "controller/model/robot_model.h"
#include "controller/params.h"
#include "controller/step.h"
#include "controller/types.h"

namespace moma {

/// Task of one step. The servo fills it, a detour may change it, terms and rows read it.
struct Task {
  Vector6 error = Vector6::Zero();        ///< [e_R; e_p]: log(R_d R^T), p_d - p, world axes [rad, m]
  Vector6 nu = Vector6::Zero();           ///< wanted twist of E, world axes [rad/s, m/s]
  double raw_error_norm = 0.0;            ///< ||e||, not clamped
  double error_norm = 0.0;                ///< ||e|| clamped to [min, max], as used in the weights
  double theta_eps = 0.0;                 ///< bearing of E seen from the base frame [rad]; 0 for a fixed base
  Vector6 slack_scale = Vector6::Ones();  ///< factors on the slack's weight, row by row
  bool detour = false;                    ///< on a detour (escape.h): its posture term acts
  Vector6 free = Vector6::Zero();         ///< not 0: of this direction, about axes of E or along axes of G, no row
  Matrix3 R_WG = Matrix3::Identity();     ///< those axes of G; unused where nothing is free
};

/// pose_error() with another e_R: roll, pitch, yaw of R^T R_d, used as a rotation vector in the axes of E and turned
/// into world axes. The two agree for small angles; large ones turn another way, and jump if the pitch reaches +-pi/2.
/// Source: p_servo() of the Robotics Toolbox for Python, which the papers' examples use.
Vector6 pose_error_rpy(const Isometry& X_WE, const Isometry& X_WG) noexcept;

/// Returns nu = [k_R e_R; k_p e_p], each part clamped in length with its direction kept, + V_d (Lynch & Park 2017,
/// 11.17, with the feed-forward of the goal, whose subscript the article's summary drops).
Vector6 servo_twist(const ServoParams& params, const Vector6& error, const Vector6& V_WG_W) noexcept;

/// The same towards a goal that is passed through: of the error times clip(pass_from / max(|e_p|, 0.3 m |e_R|), 1,
/// pass_factor), so that E keeps its speed from pass_from on, and comes pass_factor times as quickly at the end.
Vector6 passing_twist(const ServoParams& params, const Vector6& error, const Vector6& V_WG_W) noexcept;

/// ||e|| before clamping: |e_p|_2, |e_p|_1, or sqrt(|e_p|^2 + (scale |e_R|)^2).
double error_norm(const ErrorNormParams& params, const Vector6& error) noexcept;

/// Returns atan2(y, x) of E in the base frame (Haviland 2022, eq. 14).
double bearing(const Isometry& X_WB, const Vector3& p_W) noexcept;

/// The base's part of separate motion, the baseline for holistic motion: the base drives until the goal is ahead of it
/// at the distance `reach`, and stands there while the arm moves. A function of the present pose alone.
struct DriveIntoReach {
  bool driving = false;                  ///< not there yet
  Vector3 velocity_B = Vector3::Zero();  ///< (v_x, v_y, omega) in base axes [m/s, rad/s]; zero at rest
};

/// With d and a the distance and bearing of the goal from the base's origin, in the plane, the base drives while |d -
/// reach| > tolerance or |a| > bearing, by v = gain (d - reach) and omega = gain a, each within the base's speeds. A
/// base that moves along its heading only has v max(0, cos a): it turns first. A fixed base never drives. No
/// allocation.
DriveIntoReach drive_into_reach(const BaseFirstParams& params, const MobileBase& robot, const Vector3& base,
                                const Vector3& p_WG) noexcept;

}  // namespace moma
