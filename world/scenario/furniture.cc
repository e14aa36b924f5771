#include "world/scenario/furniture.h"

#include <algorithm>

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

void add_left_and_right(std::vector<WorldObject>& boxes, const FurnitureFrame& frame, const std::string& name,
                        const Vector3& center_F, const Vector3& edges) {
  boxes.push_back(furniture_box(frame, name + "_left", center_F, edges));
  boxes.push_back(furniture_box(frame, name + "_right", {center_F.x(), -center_F.y(), center_F.z()}, edges));
}

std::optional<FurnitureFrame> frame_of_passage(SceneBuilder& builder, const World& world, const WallAcross& wall,
                                               Draws& draws, const std::string& family) {
  const Vector3 start(world.start.base.x(), world.start.base.y(), 0.0);
  const Vector3 end(world.witness.base.x(), world.witness.base.y(), 0.0);
  const Vector3 way = end - start;
  FurnitureFrame frame;
  frame.yaw = std::atan2(way.y(), way.x());
  frame.origin = start + wall.along.sample(draws) * way;
  frame.origin = frame.point(0.0, wall.offset.sample(draws), 0.0);
  frame.yaw += wall.turn.sample(draws);
  if (frame.into().dot(world.goal.X_WG.translation() - frame.origin) < 0.0 ||
      frame.into().dot(end - frame.origin) < 0.0) {
    builder.reject(family + ": the goal is not behind it");
    return std::nullopt;
  }
  return frame;
}

std::vector<WorldObject> shelf_boxes(const FurnitureFrame& frame, const ShelfForm& form, const std::string& board) {
  const double pitch = form.opening + form.thickness;
  std::vector<WorldObject> boxes;
  int number = 0;
  for (double z = form.board - pitch * std::floor(form.board / pitch); z < form.total + 0.5 * form.thickness;
       z += pitch)
    boxes.push_back(furniture_box(frame, board + std::to_string(++number), {0.5 * form.depth, 0.0, z},
                                  {form.depth, form.width, form.thickness}));
  add_left_and_right(boxes, frame, "shelf", {0.5 * form.depth, 0.5 * (form.width + form.thickness), 0.5 * form.total},
                     {form.depth, form.thickness, form.total});
  if (form.back)
    boxes.push_back(furniture_box(frame, "shelf_back", {form.depth + 0.5 * form.thickness, 0.0, 0.5 * form.total},
                                  {form.thickness, form.width + 2.0 * form.thickness, form.total}));
  return boxes;
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

std::vector<WorldObject> table_boxes(const FurnitureFrame& frame, const TopForm& form) {
  constexpr double kLeg = 0.06;
  const double under = form.height - form.thickness;
  std::vector<WorldObject> boxes;
  boxes.push_back(furniture_box(frame, "table_top", {0.5 * form.depth, 0.0, form.height - 0.5 * form.thickness},
                                {form.depth, form.width, form.thickness}));
  int number = 0;
  for (const double x : {0.5 * kLeg, form.depth - 0.5 * kLeg})
    for (const double y : {0.5 * (form.width - kLeg), -0.5 * (form.width - kLeg)})
      boxes.push_back(
          furniture_box(frame, "table_leg" + std::to_string(++number), {x, y, 0.5 * under}, {kLeg, kLeg, under}));
  return boxes;
}

bool add_things_on(SceneBuilder& builder, World& world, const FurnitureFrame& frame, const TopForm& form,
                   const ObjectMix& mix, int count, const std::string& what) {
  const ObjectPlacing placing{.count = count,
                              .tries = 50,
                              .name = "item",
                              .drawn_again = "an item not clear of start and goal",
                              .out_of_tries = what + " no place for an item clear of the goal (worlds.clearance)"};
  return placing.place(builder, world, [&](const ObjectTry& at, WorldObject& item) {
    Draws draws = builder.draws(Stream::kObjects, at.item);
    // One after the other: the order of a call's arguments is the compiler's.
    const double across = draws.uniform(-0.45, 0.45) * form.width;
    const double along = draws.uniform(0.05, 0.95) * form.depth;
    const Vector3 place = frame.point(along, across, 0.0);
    mix.sample(draws, place.x(), place.y(), item);
    const double lift = form.height - lowest_point(item.shape, item.X_WO);
    set_pose(item, item.X_WO.translation() + Vector3(0.0, 0.0, lift), item.file_rotation);
    return builder.stands_clear(item, builder.clearance());
  });
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
