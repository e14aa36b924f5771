#include "controller/safe/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace moma {
namespace {

double square(double x) noexcept { return x * x; }

}  // namespace

double normal_quantile(double probability) noexcept {
  // Newton's method for Phi(z) = p from 0, where Phi is concave: it converges from below.
  double z = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double upper = 0.5 * std::erfc(z / std::numbers::sqrt2);
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
    const double step = (upper - (1.0 - probability)) / density;
    z += step;
    if (std::abs(step) < 1e-14 * (1.0 + z)) break;
  }
  return z;
}

Uncertainty::Uncertainty(const UncertaintyParams& params, int base_dof) noexcept
    : params_(params), base_dof_(base_dof), z_(normal_quantile(params.probability)) {}

PlaceSpread Uncertainty::spread(const PoseTrack& track, double lateness) const noexcept {
  const UncertaintyParams& u = params_;
  PlaceSpread out;
  const double age = lateness + track.unseen;
  double position = 0.0;
  if (track.stated) {
    out.stated = true;
    out.P_W = (track.position_covariance + square(age) * track.velocity_covariance).reshaped(3, 3);
  } else {
    position = square(u.object_bias) + square(u.object_noise) * track.pose_spread;
    if (track.moving) position += square(u.object_velocity) * (square(age) * track.twist_spread);
  }
  double rotation = square(u.object_rotation_bias) + square(u.object_rotation_noise) * track.pose_spread;
  if (track.moving || track.stated) rotation += square(u.object_angular_velocity) * (square(age) * track.twist_spread);
  position += square(u.growth * track.unseen);
  out.position = std::sqrt(position);
  out.rotation = std::sqrt(rotation);
  return out;
}

double Uncertainty::margin(const ProximityPair& pair, const Kinematics& kinematics,
                           const Eigen::Ref<const VectorX>& row, std::span<const ObjectState> states,
                           std::span<const PlaceSpread> spreads) const noexcept {
  const UncertaintyParams& u = params_;
  const Vector3& n = pair.distance.n_W;
  double variance = 0.0;
  if (pair.kind == PairKind::kObject) {
    const auto object = static_cast<std::size_t>(pair.second);
    const PlaceSpread spread = object < spreads.size() ? spreads[object] : PlaceSpread{};
    const Vector3 &p = pair.distance.p_second_W, &p_WO = states[object].X_WO.translation();
    variance += square(spread.position) + (p - p_WO).cross(n).squaredNorm() * square(spread.rotation);
    if (spread.stated) variance += std::max(0.0, n.dot(spread.P_W * n));
    if (base_dof_ > 0) {
      const Vector3 arm = p - kinematics.X_WB().translation();
      variance += n.head<2>().squaredNorm() * square(u.base_position) +
                  square(arm.x() * n.y() - arm.y() * n.x()) * square(u.base_rotation);
    }
  }
  for (Eigen::Index i = base_dof_; i < row.size(); ++i) variance += square(row[i] * u.joints);
  return z_ * std::sqrt(variance);
}

void approach_row(const ProximityPair& pair, const Kinematics& kinematics, Matrix3X& J, VectorX& row) noexcept {
  const RobotModel& model = kinematics.model();
  kinematics.point_jacobian(model.shape(pair.first).link, pair.distance.p_first_W, J);
  row.noalias() = -J.transpose() * pair.distance.n_W;
  if (pair.kind != PairKind::kSelf) return;
  // n12 = -n_W points from the first link to the second.
  kinematics.point_jacobian(model.shape(pair.second).link, pair.distance.p_second_W, J);
  row.noalias() += J.transpose() * pair.distance.n_W;
}

}  // namespace moma
