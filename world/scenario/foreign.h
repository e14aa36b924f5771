#pragma once

#include <memory>
#include <string>
#include <vector>

#include "controller/config/paths.h"
#include "controller/model/robot_model.h"
#include "world/world.h"

namespace moma {

/// Foreign problems as worlds, with notes about their changes.
struct ForeignWorlds {
  std::vector<World> worlds;
  std::vector<std::string> notes;
};

/// Reads planning problems, each file by its content:
///   - MoveIt planning scenes, as YAML or JSON of the message or as text (.scene), and motion plan requests with joint
///     goals. Scenes and requests are paired in order; one scene serves all requests.
///   - a folder of those: MotionBenchMaker's sceneNNNN.yaml and requestNNNN.yaml, in order of their names.
///   - VAMP's problems.json.
///   - moma's own scenes of boxes and configurations (world/scenario/scenes.h).
/// Poses are in the frame of an object's header if that is a link of the robot, else in the URDF's root; the base
/// stands at the origin. The goal is the tool's pose at the goal's joint values, which are the witness. A joint that a
/// start does not name is at the robot's `ready`. Planes become slabs 0.2 m thick, cones become cylinders, meshes
/// become the convex hulls of their vertices (config::point_solid()). Objects attached to a link that is rigid with
/// the end effector are held (World::held), several shapes as their convex hull. Each of these changes is noted, as are
/// worlds that start or end in contact. Throws config::ConfigError with file and line for other content, for unknown
/// shapes and goals, for joints that the robot does not control, and for objects attached to other links.
ForeignWorlds read_foreign(const std::shared_ptr<const RobotModel>& model, const std::vector<fs::path>& files);

}  // namespace moma
