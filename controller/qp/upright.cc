#include "controller/qp/upright.h"

#include <algorithm>

#include "controller/model/upright.h"

namespace moma {

void UprightRow::add(const Situation& now, QpProblem& problem) noexcept {
  if (!params_.enabled || !now.o.upright) return;
  const Upright& upright = *now.o.upright;
  const Matrix3& R_WE = now.kinematics.X_WE().linear();
  const Vector3 m = tilt_direction(upright, R_WE);
  if (m.isZero(0.0)) return;
  const double at_goal = std::min(tilt(upright, now.o.goal.X_WG.linear()), upright.angle);
  const double stop = std::max((1.0 - params_.margin) * upright.angle, at_goal);
  const double room = stop - tilt(upright, R_WE);
  const Matrix6X& J = now.kinematics.J_WE_W();
  for (Eigen::Index i = 0; i < row_.size(); ++i) row_[i] = m.dot(J.col(i).head<3>());
  double limit = params_.gain * room;
  if (braking_.enabled && room > 0.0)
    limit = std::min(limit, stoppable_speed(room, braking_.share * deceleration_.along(row_), braking_.reaction));
  problem.append({RowKind::kUpright, 0, -1}, -kInfinity, limit, row_);
}

}  // namespace moma
