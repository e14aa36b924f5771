#pragma once

#include "controller/params.h"
#include "controller/qp/problem.h"

namespace moma {

/// Acceleration bound of a linear velocity as one vector: |(x, y) - velocity| <= step.
struct LinearPair {
  bool on = false;
  Vector2 velocity = Vector2::Zero();
  double step = 0.0;
};

/// Bounds of one step on all velocities.
struct Bounds {
  VectorX lower, upper;            ///< acceleration bounds included
  VectorX hard_lower, hard_upper;  ///< [S-, S+] of the article: those that hold in every stage of the fallback
  LinearPair pair;

  void allocate(int num_velocities);
  /// Holds the base's velocities at `velocity`, as far as the bounds allow it.
  void hold_base(int base_dof, const Vector3& velocity) noexcept;
};

/// Cosine of half an octagon's angle: of an octagon in a circle, apothem over radius.
inline constexpr double kOctagon = 0.9238795325112867;

/// Writes the smallest command within lower <= upper: clip(0, lower, upper), 0 where a bound is not a number. A pair
/// gets its velocity shortened by its step.
void smallest_command(const Eigen::Ref<const VectorX>& lower, const Eigen::Ref<const VectorX>& upper,
                      const LinearPair& pair, Eigen::Ref<VectorX> out) noexcept;
double braking(double lower, double upper) noexcept;

/// Computes the bounds of every velocity: speed limits, joint limits by the chosen law, and acceleration bounds clipped
/// into those. With the law `braking` acceleration limits win: no joint changes its velocity by more than its limit, at
/// any position and in any stage of the fallback; only the speed limit has priority. One per controller; only the
/// constructor allocates.
class VelocityBounds {
 public:
  VelocityBounds(const RobotModel& model, const ControllerParams& params, double control_period);

  /// Writes all bounds for the joint values q and the measured velocity. `hold`: control periods that the command may
  /// have to act (Situation::hold); it lengthens the reaction of the law `braking`.
  void bound(const VectorX& q, const VectorX& qdot_measured, double hold, Bounds& out) const noexcept;
  /// Writes the smallest command within the bounds, each velocity by itself. If q or the measured velocity has
  /// the right size, its finite elements still bound the command. `work` holds those bounds afterwards.
  void brake(const VectorX& q, const VectorX& qdot_measured, Bounds& work, VectorX& command) const noexcept;
  /// Writes the bounds without acceleration for the joint values q.
  void joint_limits(const Eigen::Ref<const VectorX>& q, Eigen::Ref<VectorX> lower, Eigen::Ref<VectorX> upper,
                    double hold = 1.0) const noexcept;
  /// Writes clip(qdot -+ a_max dt, [hard_lower, hard_upper]).
  void acceleration(const VectorX& qdot_measured, const Eigen::Ref<const VectorX>& hard_lower,
                    const Eigen::Ref<const VectorX>& hard_upper, Eigen::Ref<VectorX> lower,
                    Eigen::Ref<VectorX> upper) const noexcept;
  /// Returns the linear pair of an omnidirectional base whose drives are bounded (limits.base); off for other bases.
  LinearPair linear_pair(const VectorX& qdot) const noexcept;
  /// True where the bounds without acceleration are wider than those with.
  bool has_soft_acceleration() const noexcept { return has_soft_acceleration_; }
  /// Largest speeds, base first.
  const VectorX& speed() const noexcept { return speed_; }

 private:
  int base_dof_;
  JointLimitParams law_;
  VectorX speed_;
  VectorX q_lower_, q_upper_, margin_;
  VectorX part_;          // factor on the dampers' lengths
  VectorX step_;          // a_max dt
  VectorX deceleration_;  // of the law `braking`, per joint
  double period_;         // [s]
  bool hard_base_ = false, hard_joints_ = false, pair_ = false;
  bool has_soft_acceleration_ = false;
};

/// Returns the largest speed v of a base that still stops in front of an object that approaches at `speed` and is seen
/// at `range`: v t + v^2/(2a) + speed (t + v/a) = range - reach. At most the robot's own speed; 0 without a solution.
double sight_speed(const SightParams& sight, const RobotModel& model, double deceleration) noexcept;

/// Returns the largest magnitude that the bounds allow each linear velocity of the base: the robot's, and its share of
/// sight_speed() [m/s].
double bounded_speed(const RobotModel& model, const ControllerParams& params) noexcept;

/// Returns q_s per joint: min(0.3, a quarter of the range) if it is `automatic`, else the given one. Infinite joints
/// get an unused 0.3.
VectorX resolve_margin(const RobotModel& model, const JointMargin& given);

/// Appends |omega_i| <= max_speed for every wheel, as rows on the base's velocity.
void add_wheel_rows(const MobileBase& base, QpProblem& problem) noexcept;
/// Appends |x + y|, |x - y| <= sqrt(2) step about the pair's velocity. With the bounds |x|, |y| <= step they form the
/// octagon of that apothem around the circle. Appends nothing for a pair that is off.
void add_drive_rows(const LinearPair& pair, QpProblem& problem) noexcept;

}  // namespace moma
