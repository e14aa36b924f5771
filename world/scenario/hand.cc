#include "world/scenario/hand.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace moma {

Hand hand_at_witness(SceneBuilder& builder, const World& world, const std::string& family) {
  Kinematics at(builder.model_pointer());
  at.update(world.witness.base, world.witness.q);
  std::vector<std::pair<const Shape*, Isometry>> shapes;
  for (const int i : builder.model().hand_shapes()) {
    const CollisionShape& shape = builder.model().shape(i);
    shapes.emplace_back(&shape.shape, at.X_WS(shape));
  }

  Hand hand;
  hand.point = at.X_WE().translation();
  hand.thin.setZero();
  if (shapes.empty()) {
    builder.reject(family + ": the robot has no shape that moves with its end effector");
    return hand;
  }
  const auto beyond = [&](const Vector3& n) {
    double most = -std::numeric_limits<double>::infinity();
    for (const auto& [shape, X_WS] : shapes) most = std::max(most, extent_along(*shape, X_WS, n));
    return most - n.dot(hand.point);
  };
  constexpr double kWrist = 0.03;  // the wrist is the first link whose origin is so far from E at least [m]
  const Vector3 along = at.X_WE().linear().transpose() * builder.approach(kWrist);
  Eigen::Index axis = 0;
  along.cwiseAbs().maxCoeff(&axis);
  hand.into = std::copysign(1.0, along[axis]) * at.X_WE().linear().col(axis);
  hand.reach = beyond(hand.into);

  constexpr int kDirections = 36;
  constexpr double kThinner = 1e-6;  // so that rounding never chooses among directions that are equal [m]
  const Vector3 u = at.X_WE().linear().col((axis + 1) % 3);
  const Vector3 v = hand.into.cross(u);
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kDirections; ++k) {
    const double angle = k * std::numbers::pi / kDirections;
    const Vector3 n = std::cos(angle) * u + std::sin(angle) * v;
    const double above = beyond(n), below = beyond(-n);
    if (above + below >= least - kThinner) continue;
    least = above + below;
    hand.thin = n;
    hand.above = above;
    hand.below = below;
  }
  return hand;
}

bool bring_to_hand(SceneBuilder& builder, const Hand& hand, const Vector3& aside, const Eigen::Quaterniond& rotation,
                   double clearance, const std::string& family, WorldObject& object) {
  constexpr double kBefore = 0.05;  // the object begins so far before the hand [m]
  constexpr double kDeepest = 0.3;  // and passes its foremost point by this at most [m]
  const double far = hand.reach + clearance + bounding_radius(object.shape) + kBefore;
  set_pose(object, hand.point + far * hand.into + aside, rotation);
  if (!builder.bring_near(object, -hand.into, far + kDeepest, clearance))
    return builder.reject(family + ": the object meets the arm, or no hand (clearance)");
  const double nearest = -extent_along(object.shape, object.X_WO, -hand.into) - hand.into.dot(hand.point);
  if (nearest > hand.reach + clearance + 1e-3)
    return builder.reject(family + ": the arm is nearer to the object than the hand");
  return true;
}

Eigen::Quaterniond rotation_along(const Vector3& z, const Vector3& x) {
  Matrix3 R;
  R.col(2) = z.normalized();
  R.col(1) = R.col(2).cross(x).normalized();
  R.col(0) = R.col(1).cross(R.col(2));
  return Eigen::Quaterniond(R).normalized();
}

}  // namespace moma
