#include "controller/fit/placed.h"

#include <algorithm>
#include <cmath>

#include "controller/config/robot_file.h"

namespace moma::fit {
namespace {

constexpr double kSlack = 1e-9;  // margin for rounding in later measurements [m]

double nearest(double value) { return std::round(value / kGrid) / std::round(1.0 / kGrid) + 0.0; }
double upward(double value) { return std::ceil((value + kSlack) / kGrid) / std::round(1.0 / kGrid); }

// Angles about fixed axes x, y, z: R = Rz Ry Rx.
Vector3 angles_of(const Matrix3& R) {
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  if (std::hypot(R(0, 0), R(1, 0)) < 1e-9) return {std::atan2(-R(1, 2), R(1, 1)), pitch, 0.0};
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

// A capsule is symmetric about its axis and reversible: no roll, and a pitch of at most a right angle.
Vector3 angles_of_axis(Vector3 axis) {
  if (axis.z() < 0.0) axis = -axis;
  const double across = std::hypot(axis.x(), axis.y());
  const double pitch = std::atan2(across, axis.z());
  return {0.0, pitch, nearest(pitch) > 0.0 ? std::atan2(axis.y(), axis.x()) : 0.0};
}

Isometry pose_of(const Vector3& position, const Vector3& rpy) {
  Isometry X = Isometry::Identity();
  X.linear() = config::rotation_of(rpy);
  X.translation() = position;
  return X;
}

Vector3 size_around(const Shape& shape, const Isometry& X_LS, const Points& points) {
  const Isometry X_SL = X_LS.inverse();
  Vector3 box = Vector3::Zero();
  double ball = 0.0;
  double disc = 0.0;
  for (const Vector3& p : points) {
    const Vector3 local = X_SL * p;
    box = box.cwiseMax(local.cwiseAbs());
    ball = std::max(ball, local.norm());
    disc = std::max(disc, local.head<2>().norm());
  }
  if (shape.kind == ShapeKind::kSphere) return {upward(std::max(ball, 0.5 * kThinnest)), 0.0, 0.0};
  if (shape.kind == ShapeKind::kBox) {
    for (double& edge : box) edge = upward(std::max(2.0 * edge, kThinnest));
    return box;
  }
  const double radius = upward(std::max({disc, shape.size.x() - kSlack, 0.5 * kThinnest}));
  double half = 0.0;
  for (const Vector3& p : points) {
    const Vector3 local = X_SL * p;
    const double cap = std::sqrt(std::max(0.0, radius * radius - local.head<2>().squaredNorm()));
    half = std::max(half, std::abs(local.z()) - cap);
  }
  return {radius, std::max(upward(2.0 * half), kGrid), 0.0};
}

}  // namespace

Placed rounded(const Solid& solid, const Points& points) {
  Placed placed;
  for (int i = 0; i < 3; ++i) placed.position[i] = nearest(solid.X_LS.translation()[i]);
  if (solid.shape.kind != ShapeKind::kSphere) {
    const Matrix3 R = solid.X_LS.linear();
    placed.rpy = solid.shape.kind == ShapeKind::kCapsule ? angles_of_axis(R.col(2)) : angles_of(R);
    for (double& angle : placed.rpy) angle = nearest(angle);
  }
  placed.solid.X_LS = pose_of(placed.position, placed.rpy);
  placed.solid.shape = {solid.shape.kind, size_around(solid.shape, placed.solid.X_LS, points), nullptr};
  return placed;
}

Placed as_it_is(const Shape& shape, const Isometry& X_LS) {
  Placed placed;
  placed.position = X_LS.translation();
  placed.rpy = angles_of(X_LS.linear());
  placed.solid.shape = shape;
  placed.solid.X_LS = pose_of(placed.position, placed.rpy);
  return placed;
}

}  // namespace moma::fit
