#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "controller/config/node.h"
#include "controller/config/robot_file.h"
#include "world/plant/plant.h"
#include "world/scenario/family.h"
#include "world/scenario/worlds.h"

namespace moma::test {

/// A robot that the project ships, read once per test program.
inline std::shared_ptr<const RobotModel> robot(const std::string& name) {
  return config::load_robot(std::string(MOMA_SOURCE_DIR) + "/configs/robots/" + name + ".yaml").model;
}

inline Worlds worlds(const std::string& yaml) { return Worlds::read(config::parse_yaml(yaml, "test.yaml"), "worlds"); }

/// A Panda whose mount is raised [m].
inline std::shared_ptr<const RobotModel> panda_at(double height) {
  const std::string text = "include: " MOMA_SOURCE_DIR
                           "/configs/robots/panda.yaml\nbase: {type: fixed, mount: {position: [0, 0, " +
                           std::to_string(height) + "]}}\n";
  return config::read_robot(config::parse_yaml(text, "raised.yaml"), "").model;
}

/// A robot as a family needs it: a Panda on a desk is raised.
inline std::shared_ptr<const RobotModel> robot_for(const std::string& name, const std::string& family) {
  return name == "panda" && family == "desk" ? panda_at(0.75) : robot(name);
}

/// True where no world can be made because the family is for bases that drive, and this one does not, or for robots on
/// a table, and this one is on none. A family that cannot be made for another reason throws.
inline bool is_for_others(const Worlds& source, const std::shared_ptr<const RobotModel>& model) {
  try {
    source.make(model, 0);
    return false;
  } catch (const GenerationError& error) {
    const std::string why = error.what();
    const bool told = !model->mobile() && (why.find("a fixed base cannot") != std::string::npos ||
                                           why.find("stands too low for a table") != std::string::npos);
    if (!told && !(model->mobile() && why.find("cannot stand on a table") != std::string::npos)) throw;
    return true;
  }
}

/// Distance that objects keep from the witness: the family's own `clearance`, or worlds.clearance where it has none.
inline double at_witness(const Worlds& source) {
  return source.to_json()["families"].begin().value().value("clearance", source.clearance());
}

/// A name of a robot or family as part of a test's name.
inline std::string part_of_name(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

/// Families that are made for robots that drive.
inline std::vector<std::string> families_for_driving() {
  std::vector<std::string> names;
  for (const FamilyType& type : family_types())
    if (type.name != "desk") names.emplace_back(type.name);
  return names;
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
