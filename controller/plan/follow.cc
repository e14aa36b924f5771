#include "controller/plan/follow.h"

#include <algorithm>
#include <cmath>

namespace moma {
WholeConfiguration PlanarShift::of(const WholeConfiguration& c) const noexcept {
  WholeConfiguration out = c;
  const double cs = std::cos(turn), sn = std::sin(turn);
  out[0] = move.x() + cs * c[0] - sn * c[1];
  out[1] = move.y() + sn * c[0] + cs * c[1];
  out[2] = c[2] + turn;
  return out;
}

MotionState PlanarShift::of(const MotionState& motion) const noexcept {
  MotionState out{of(motion.c), motion.v};
  out.v.head<2>() = Eigen::Rotation2Dd(turn) * motion.v.head<2>();
  return out;
}

WholeConfiguration PlanarShift::turned_back(const WholeConfiguration& change) const noexcept {
  WholeConfiguration out = change;
  out.head<2>() = Eigen::Rotation2Dd(-turn) * change.head<2>();
  return out;
}

Isometry PlanarShift::back(const Isometry& X) const noexcept {
  Isometry shift = Isometry::Identity();
  shift.translation().head<2>() = move;
  shift.linear() = Eigen::AngleAxisd(turn, Vector3::UnitZ()).toRotationMatrix();
  return shift.inverse() * X;
}

PlanarShift shift_of_goal(bool mobile, const Isometry& X_WG_then, const Isometry& X_WG_now) noexcept {
  PlanarShift shift;
  if (!mobile) return shift;
  // The turn about z that is nearest to the goal's rotation (in the Frobenius norm).
  const Matrix3 R = X_WG_now.linear() * X_WG_then.linear().transpose();
  shift.turn = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
  const double cs = std::cos(shift.turn), sn = std::sin(shift.turn);
  const Vector3 then = X_WG_then.translation(), now = X_WG_now.translation();
  shift.move << now.x() - (cs * then.x() - sn * then.y()), now.y() - (sn * then.x() + cs * then.y());
  return shift;
}

double path_lag(const MotionLimits& limits, const PlanParams& params, const WholeConfiguration& c,
                const Observation& o) noexcept {
  double lag = params.follow.joint * (c.tail(limits.num_joints()) - o.q).lpNorm<Eigen::Infinity>();
  if (limits.mobile())
    lag = std::max(
        {lag, (c.head<2>() - o.base.head<2>()).norm(), params.follow.heading * std::abs(wrapped(c[2] - o.base.z()))});
  return lag;
}

FollowStep follow_path(const MotionLimits& limits, const PlanParams& params, const Path& path, double t, double dt,
                       double most_rate, const PlanarShift& shift, const Observation& o, VectorX& u) noexcept {
  const int joints = limits.num_joints();
  WholeConfiguration here, next;
  path.at(t, here);
  path.at(t + dt, next);
  here = shift.of(here);
  next = shift.of(next);
  const Vector2 way = here.head<2>() - o.base.head<2>();
  const double turn = wrapped(here[2] - o.base.z());
  FollowStep step;
  step.lag = path_lag(limits, params, here, o);
  step.rate = std::clamp(1.5 - step.lag / params.lag, 0.0, most_rate);
  const double per_second = step.rate / dt;
  const Eigen::Rotation2Dd R_BW(-o.base.z());
  const Vector2 way_B = R_BW * way;
  const WholeConfiguration v = per_second * (next - here);
  const double k = params.gain;
  u.setZero();
  if (limits.base->nonholonomic()) {
    const double forwards = std::cos(here[2]) * v[0] + std::sin(here[2]) * v[1];
    u[0] = forwards * std::cos(turn) + k * way_B.x();
    u[1] = v[2] + k * turn + params.follow.across * forwards * way_B.y();
  } else if (limits.base->lateral()) {
    u.head<2>() = R_BW * v.head<2>() + k * way_B;
    u[2] = v[2] + k * turn;
  }
  const Eigen::Index first = u.size() - joints;
  for (int i = 0; i < joints; ++i) u[first + i] = v[3 + i] + k * (here[3 + i] - o.q[i]);
  return step;
}

}  // namespace moma
