#pragma once

#include "controller/params.h"
#include "controller/qp/problem.h"

namespace moma {

/// Velocity bounds of every velocity coordinate: speed limits, joint limits by the chosen law, and acceleration
/// bounds clipped into those. Built once per controller; nothing but the constructor takes memory.
class VelocityBounds {
 public:
  VelocityBounds(const RobotModel& model, const ControllerParams& params, double control_period);

  /// Writes the bounds without acceleration, [S-, S+] of the source, for the joint values q.
  void joint_limits(const Eigen::Ref<const VectorX>& q, Eigen::Ref<VectorX> lower,
                    Eigen::Ref<VectorX> upper) const noexcept;
  /// Writes clip(qdot -+ a_max dt, [hard_lower, hard_upper]).
  void acceleration(const VectorX& qdot_measured, const Eigen::Ref<const VectorX>& hard_lower,
                    const Eigen::Ref<const VectorX>& hard_upper, Eigen::Ref<VectorX> lower,
                    Eigen::Ref<VectorX> upper) const noexcept;
  /// True where any acceleration bound is finite.
  bool has_acceleration() const noexcept { return has_acceleration_; }
  /// Largest speeds, base first.
  const VectorX& speed() const noexcept { return speed_; }

 private:
  int base_dof_;
  JointLimitParams law_;
  VectorX speed_;
  VectorX q_lower_, q_upper_, margin_;
  VectorX step_;  // a_max dt
  bool has_acceleration_ = false;
};

/// q_s = min(0.3, a quarter of the range) for `auto_margin`, else as given; infinite joints get 0.3, unused.
VectorX resolve_margin(const RobotModel& model, const JointLimitParams& params);

/// The source's S+ (and, mirrored, S-): 0 where room < 0, else speed min(room / margin, 1).
double source_bound(double room, double margin, double speed) noexcept;

/// eta (rho - rho_s)/(rho_i - rho_s) inside rho_i, infinite outside (Haviland & Corke, arXiv 2002.11901, eq. 19).
double damper_bound(double room, const JointLimitParams& params) noexcept;

/// Writes the speeds of the wheels [rad/s] for the base's part of `velocity`: left, right; or FL, FR, RL, RR.
/// Returns how many there are, 0 without wheels.
int wheel_speeds(const MobileBase& base, const Eigen::Ref<const VectorX>& velocity, Eigen::Vector4d& speeds) noexcept;

/// |omega_i| <= max_speed for every wheel, as rows on the base's velocity.
void add_wheel_rows(const MobileBase& base, QpProblem& problem) noexcept;
/// 2, 4 or 0.
int num_wheels(const MobileBase& base) noexcept;

}  // namespace moma
