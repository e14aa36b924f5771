#include "world/scenario/furniture.h"

#include <algorithm>
#include <cmath>

namespace moma {

Vector3 FurnitureFrame::point(double x, double y, double z) const {
  const double c = std::cos(yaw), s = std::sin(yaw);
  return origin + Vector3(c * x - s * y, s * x + c * y, z);
}

WorldObject furniture_box(const FurnitureFrame& frame, const std::string& name, const Vector3& center_F,
                          const Vector3& edges) {
  WorldObject object;
  object.name = name;
  object.shape.kind = ShapeKind::kBox;
  object.shape.size = edges;
  set_pose(object, frame.point(center_F.x(), center_F.y(), center_F.z()),
           Eigen::Quaterniond(std::cos(0.5 * frame.yaw), 0.0, 0.0, std::sin(0.5 * frame.yaw)));
  return object;
}

bool add_furniture(SceneBuilder& builder, std::vector<WorldObject> boxes, const std::string& what, World& world) {
  for (WorldObject& box : boxes) {
    if (box.X_WO.translation().z() + 0.5 * box.shape.size.z() <= 0.0 || box.shape.size.minCoeff() <= 0.0) continue;
    if (!builder.stands_clear(box, builder.clearance()))
      return builder.reject(what + " not clear of start and goal (worlds.clearance)");
    world.objects.push_back(std::move(box));
  }
  return true;
}

double base_half_width(const SceneBuilder& builder) {
  const RobotModel& model = builder.model();
  Kinematics kinematics(builder.model_pointer());
  kinematics.update(Vector3::Zero(), model.ready);
  double half = 0.0;
  for (const CollisionShape& shape : model.shapes) {
    if (!shape.rigid_with_base) continue;
    for (const double side : {1.0, -1.0})
      half = std::max(half, extent_along(shape.shape, kinematics.X_WS(shape), {0.0, side, 0.0}));
  }
  return half;
}

double heading_to_goal(const World& world) {
  const Vector3 p = world.goal.X_WG.translation();
  return std::atan2(p.y() - world.witness.base.y(), p.x() - world.witness.base.x());
}

}  // namespace moma
