#include "controller/safe/braking.h"

#include <algorithm>
#include <cmath>

#include "controller/model/base_kind.h"

namespace moma {

Deceleration::Deceleration(const RobotModel& model, const VectorX& acceleration_limit, bool pair_together)
    : acceleration_(acceleration_limit),
      base_dof_(model.base_dof()),
      pair_(pair_together && kind_of(model.base.type).lateral()) {
  base_.head(base_dof_) = acceleration_limit.head(base_dof_);
}

void Deceleration::set_slowing(double share) noexcept { acceleration_.head(base_dof_) = share * base_.head(base_dof_); }

double Deceleration::along(const Eigen::Ref<const VectorX>& c) const noexcept {
  double sum = 0.0;
  Eigen::Index i = 0;
  if (pair_) {
    sum = acceleration_[0] * std::hypot(c[0], c[1]);
    i = 2;
  }
  for (; i < c.size(); ++i)
    if (c[i] != 0.0) sum += std::abs(c[i]) * acceleration_[i];
  return sum;
}

void Deceleration::stopping_times(const VectorX& u, VectorX& times) const noexcept {
  for (Eigen::Index i = 0; i < u.size(); ++i) times[i] = std::abs(u[i]) / acceleration_[i];
  if (pair_) times[0] = times[1] = std::hypot(u[0], u[1]) / acceleration_[0];
}

double stoppable_speed(double room, double deceleration, double reaction) noexcept {
  if (!(room > 0.0)) return 0.0;
  if (std::isinf(deceleration)) return reaction > 0.0 ? room / reaction : deceleration;
  const double lost = deceleration * reaction;
  return std::sqrt(lost * lost + 2.0 * deceleration * room) - lost;
}

}  // namespace moma
