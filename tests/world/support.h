#pragma once

#include <algorithm>
#include <memory>
#include <string>

#include "controller/config/robot_file.h"
#include "world/plant/plant.h"
#include "world/scenario/worlds.h"

namespace moma::test {

/// A robot that the project ships, read once per test program.
inline std::shared_ptr<const RobotModel> robot(const std::string& name) {
  return config::load_robot(std::string(MOMA_SOURCE_DIR) + "/configs/robots/" + name + ".yaml").model;
}

inline Worlds worlds(const std::string& yaml) { return Worlds::read(config::parse_yaml(yaml, "test.yaml"), "worlds"); }

/// True where no world can be made because the family is for bases that drive, and this one does not. A family that
/// cannot be made for another reason throws.
inline bool needs_driving(const Worlds& source, const std::shared_ptr<const RobotModel>& model) {
  if (model->mobile()) return false;
  try {
    source.make(model, 0);
    return false;
  } catch (const GenerationError& error) {
    if (std::string(error.what()).find("a fixed base cannot") == std::string::npos) throw;
    return true;
  }
}

/// The robot at rest at the origin, nothing around it.
inline World empty_world(const RobotModel& model) {
  World world;
  world.start.q = model.ready;
  world.witness = world.start;
  return world;
}

inline WorldObject solid(const std::string& name, ShapeKind kind, const Vector3& size, const Vector3& position) {
  WorldObject object;
  object.name = name;
  object.shape.kind = kind;
  object.shape.size = size;
  set_pose(object, position, Eigen::Quaterniond::Identity());
  return object;
}

/// Distance from the base's own shapes to the object, the base at the origin.
inline double base_gap(const RobotModel& model, const WorldObject& object) {
  double least = 1e9;
  for (const CollisionShape& shape : model.shapes)
    if (shape.link == 0) least = std::min(least, shape_distance(shape.shape, shape.X_LS, object.shape, object.X_WO).d);
  return least;
}

}  // namespace moma::test
