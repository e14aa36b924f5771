#include "controller/qp/end_rows.h"

#include <utility>

namespace moma {
namespace {

// Centres of the cap spheres at -z and +z; a capsule without length is one ball, which the pair's own row covers.
int cap_centres(const Shape& shape, const Isometry& X_WS, std::array<Vector3, 2>& centres) noexcept {
  if (shape.kind != ShapeKind::kCapsule || !(shape.size.y() > 0.0)) return 0;
  const Vector3 half = 0.5 * shape.size.y() * X_WS.linear().col(2);
  centres = {Vector3(X_WS.translation() - half), Vector3(X_WS.translation() + half)};
  return 2;
}

}  // namespace

int end_distances(Proximity& proximity, const Kinematics& kinematics, const ProximityPair& pair,
                  const ObjectState& object, std::span<EndDistance, kMaxEnds> out) noexcept {
  const CollisionShape& robot = kinematics.model().shapes[static_cast<std::size_t>(pair.first)];
  const Shape& other = proximity.object_shape(pair.second);
  std::array<Vector3, 2> centres;
  int count = 0;
  for (int i = 0; i < cap_centres(robot.shape, kinematics.X_WS(robot), centres); ++i) {
    out[static_cast<std::size_t>(count++)] = {
        1 + i,
        proximity.ball_to_object(centres[static_cast<std::size_t>(i)], robot.shape.size.x(), pair.second, object.X_WO)};
  }
  for (int i = 0; i < cap_centres(other, object.X_WO, centres); ++i) {
    Distance distance = proximity.ball_to_robot(centres[static_cast<std::size_t>(i)], other.size.x(), pair.first);
    distance.n_W = -distance.n_W;
    std::swap(distance.p_first_W, distance.p_second_W);
    out[static_cast<std::size_t>(count++)] = {3 + i, distance};
  }
  return count;
}

}  // namespace moma
