#include "world/scenario/hand.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace moma {
namespace {

/// The link that the last controlled joint before `link` moves; 0 if there is none.
int moved_link(const RobotModel& model, int link) {
  while (link > 0 && model.links[static_cast<std::size_t>(link)].controlled < 0)
    link = model.links[static_cast<std::size_t>(link)].parent;
  return link;
}

/// From the wrist to E: the first link whose origin is not in E itself.
Vector3 reach_of(const Kinematics& at) {
  constexpr double kApart = 0.03;  // [m]
  const RobotModel& model = at.model();
  for (int link = model.tip; link > 0; link = model.links[static_cast<std::size_t>(link)].parent) {
    const Vector3 reach = at.X_WE().translation() - at.X_WL(link).translation();
    if (reach.norm() >= kApart) return reach;
  }
  return at.X_WE().linear().col(2);
}

}  // namespace

Hand hand_at_witness(SceneBuilder& builder, const World& world, const std::string& family) {
  Kinematics at(builder.model_pointer());
  at.update(world.witness.base, world.witness.q);
  const RobotModel& model = builder.model();
  const int moved = moved_link(model, model.tip);
  std::vector<std::pair<const Shape*, Isometry>> shapes;
  for (const CollisionShape& shape : model.shapes)
    if (moved_link(model, shape.link) == moved) shapes.emplace_back(&shape.shape, at.X_WS(shape));

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
  const Vector3 along = at.X_WE().linear().transpose() * reach_of(at);
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

Eigen::Quaterniond rotation_along(const Vector3& z, const Vector3& x) {
  Matrix3 R;
  R.col(2) = z.normalized();
  R.col(1) = R.col(2).cross(x).normalized();
  R.col(0) = R.col(1).cross(R.col(2));
  return Eigen::Quaterniond(R).normalized();
}

}  // namespace moma
