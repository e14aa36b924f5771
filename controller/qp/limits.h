#pragma once

#include "controller/params.h"
#include "controller/qp/problem.h"

namespace moma {

/// Two velocities that change together: |(x, y) - velocity| <= step.
struct LinearPair {
  bool on = false;
  Vector2 velocity = Vector2::Zero();
  double step = 0.0;
};

/// Cosine of half an octagon's angle: of an octagon in a circle, apothem over radius.
inline constexpr double kOctagon = 0.9238795325112867;

/// The smallest command within lower <= upper: clip(0, lower, upper), 0 where a bound is not a number; of a pair, its
/// velocity shortened by its step.
void smallest_command(const Eigen::Ref<const VectorX>& lower, const Eigen::Ref<const VectorX>& upper,
                      const LinearPair& pair, Eigen::Ref<VectorX> out) noexcept;
/// Of one velocity.
double braking(double lower, double upper) noexcept;

/// Velocity bounds of every velocity coordinate: speed limits, joint limits by the chosen law, and acceleration
/// bounds clipped into those. Built once per controller; nothing but the constructor takes memory.
class VelocityBounds {
 public:
  VelocityBounds(const RobotModel& model, const ControllerParams& params, double control_period);

  /// Writes the bounds without acceleration, [S-, S+] of the article, for the joint values q.
  void joint_limits(const Eigen::Ref<const VectorX>& q, Eigen::Ref<VectorX> lower,
                    Eigen::Ref<VectorX> upper) const noexcept;
  /// Whether those of the base hold in every stage of the fallback.
  bool hard_base() const noexcept { return hard_base_; }
  /// Writes clip(qdot -+ a_max dt, [hard_lower, hard_upper]).
  void acceleration(const VectorX& qdot_measured, const Eigen::Ref<const VectorX>& hard_lower,
                    const Eigen::Ref<const VectorX>& hard_upper, Eigen::Ref<VectorX> lower,
                    Eigen::Ref<VectorX> upper) const noexcept;
  /// The linear pair of an omnidirectional base whose drives bound it as one vector; off where nothing holds it.
  LinearPair linear_pair(const VectorX& qdot) const noexcept;
  /// True where any acceleration bound is finite.
  bool has_acceleration() const noexcept { return has_acceleration_; }
  /// Largest speeds, base first.
  const VectorX& speed() const noexcept { return speed_; }

 private:
  int base_dof_;
  JointLimitParams law_;
  VectorX speed_;
  VectorX q_lower_, q_upper_, margin_;
  VectorX part_;  // of the dampers' lengths
  VectorX step_;  // a_max dt
  bool hard_base_ = false, pair_ = false;
  bool has_acceleration_ = false;
};

/// Speed v from which a base stops in front of what comes towards it at `speed` and is seen at `range`:
/// v t + v^2/(2a) + speed (t + v/a) = range - reach. Not above the robot's own; 0 where there is none.
double sight_speed(const SightParams& sight, const RobotModel& model, double deceleration) noexcept;

/// q_s = min(0.3, a quarter of the range) for `auto_margin`, else as given; infinite joints get 0.3, unused.
VectorX resolve_margin(const RobotModel& model, const JointLimitParams& params);

/// The source's S+ (and, mirrored, S-): 0 where room < 0, else speed min(room / margin, 1).
double source_bound(double room, double margin, double speed) noexcept;

/// eta (rho - rho_s)/(rho_i - rho_s) inside rho_i, infinite outside (Haviland & Corke, arXiv 2002.11901, eq. 19). With
/// a `part` below 1 (limit_part()) rho_i and rho_s are so much shorter, and the slope is the same.
double damper_bound(double room, const JointLimitParams& params, double part = 1.0) noexcept;

/// |omega_i| <= max_speed for every wheel, as rows on the base's velocity.
void add_wheel_rows(const MobileBase& base, QpProblem& problem) noexcept;
/// |(x, y) - velocity| <= step from inside: with the bounds of the two, |x|, |y| <= step about it, the octagon of that
/// apothem. Nothing for a pair that is off.
void add_drive_rows(const LinearPair& pair, QpProblem& problem) noexcept;

}  // namespace moma
