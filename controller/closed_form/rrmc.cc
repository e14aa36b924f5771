#include <algorithm>
#include <cmath>

#include "controller/closed_form/closed_form.h"
#include "controller/model/base_kind.h"

namespace moma {

void rrmc(const DampedInverse& inverse, const Matrix6X& J, const Vector6& nu, VectorX& qdot) noexcept {
  inverse.apply(J, nu, qdot);
}

void scale_into_limits(const RobotModel& model, const VectorX& speed, VectorX& qdot) noexcept {
  double factor = 1.0;
  for (Eigen::Index i = 0; i < qdot.size(); ++i) {
    const double size = std::abs(qdot[i]);
    if (size > speed[i]) factor = std::min(factor, speed[i] / size);
  }
  Eigen::Vector4d wheels;
  const int count = wheel_speeds(model.base, qdot, wheels);
  for (int i = 0; i < count; ++i) {
    const double size = std::abs(wheels[i]);
    if (size > model.base.wheels->max_speed) factor = std::min(factor, model.base.wheels->max_speed / size);
  }
  qdot *= factor;
  // Rounding of the product may leave a value a last bit outside.
  qdot = qdot.cwiseMax(-speed).cwiseMin(speed);
}

}  // namespace moma
