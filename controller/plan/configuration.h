#pragma once

#include <cmath>
#include <numbers>

#include "controller/model/base_kind.h"
#include "controller/model/kinematics.h"
#include "controller/model/robot_model.h"
#include "controller/params.h"

namespace moma {

/// Base (x, y, phi) in W and one value per controlled joint; phi is not wrapped. Its fixed capacity of 3 + kMaxJoints
/// values never allocates.
using WholeConfiguration = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3 + kMaxJoints, 1>;

/// Jacobian of E with respect to a base that moves freely in the plane, and the joints (free_jacobian()).
using WholeJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 3 + kMaxJoints>;

inline constexpr double kFullTurn = 2.0 * std::numbers::pi;

/// A place and its velocity in W.
struct MotionState {
  WholeConfiguration c, v;

  bool moves() const noexcept { return !v.isZero(0.0); }
};

/// Limits of paths, and lever arms, of one robot with one controller.
struct MotionLimits {
  MotionLimits(const RobotModel& model, const ControllerParams& params);

  const BaseKind* base;
  VectorX lower, upper;         ///< joint limits, infinite without one [rad, m]
  VectorX margin;               ///< margin of a path from them [rad, m]
  VectorX part;                 ///< limit_part() of the joints
  Eigen::VectorXi winds;        ///< 1 for a joint with a range beyond one turn: a path keeps to one turn
  VectorX joint_speed;          ///< [rad/s, m/s]
  VectorX joint_acceleration;   ///< may be infinite [rad/s^2, m/s^2]
  double linear, angular;       ///< speeds of the base [m/s, rad/s]
  double linear_acceleration;   ///< [m/s^2]
  double angular_acceleration;  ///< [rad/s^2]
  Vector2 capability;           ///< these two with a drive that follows as its file says
  VectorX lever;                ///< typical travel of the robot's farthest point per motion of a joint [m/rad, 1]
  double base_lever = 0.8;      ///< and per turn of the base [m/rad]

  /// Wheel limit of a differential base: |v| + half_track |omega| <= rim_speed [m, m/s].
  double half_track = 0.0, rim_speed = kInfinity;

  /// Turning that a differential base takes upon itself in order to drive forwards [rad]; 0: the shorter turn decides.
  double facing = 0.0;
  /// True if a drive to a point at this distance, `along` of it ahead, goes backwards [m].
  bool drives_backwards(double along, double distance) const noexcept {
    return along < -std::sin(0.5 * facing) * distance;
  }

  /// Sets the accelerations of a base whose drive follows with this share of its own (Predictor::drive()).
  void set_drive(double share) noexcept {
    linear_acceleration = share * capability[0];
    angular_acceleration = share * capability[1];
  }

  /// Returns the squared distance of two configurations [m^2]: of the base's way, 0.3 m per rad of its heading, and
  /// half of the typical travel that each joint causes, by `lever`. A turn of the wrist moves little, so that it hardly
  /// counts.
  double distance_squared(const Eigen::Ref<const VectorX>& a, const WholeConfiguration& b) const noexcept;

  /// Returns the approximate travel of the robot's farthest point as the configuration changes by so much [m].
  double travel(const WholeConfiguration& change) const noexcept;

  int num_joints() const noexcept { return static_cast<int>(lower.size()); }
  bool mobile() const noexcept { return base->dof() > 0; }
};

}  // namespace moma
