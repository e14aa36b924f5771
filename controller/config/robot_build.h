#pragma once

#include <string>
#include <vector>

#include "controller/config/mesh_hull.h"
#include "controller/config/package_path.h"
#include "controller/config/reader.h"
#include "controller/config/robot_file.h"
#include "controller/model/proximity.h"
#include "controller/model/robot_model.h"
#include "controller/model/urdf.h"

namespace moma::config {

/// A robot while its file is read: each part below adds its share to the model and to the resolved form.
struct RobotBuild {
  MeshSolids* meshes = nullptr;
  RobotModel model;
  UrdfTree tree;  ///< link i of the tree is link i + 1 of the model
  PackagePaths packages;
  Json resolved = Json::object();
  std::vector<std::string> warnings;
  std::vector<std::string> notes;
};

/// read_robot() that takes solids from `meshes`, and adds those that are not there.
LoadedRobot read_robot(const Node& node, const std::string& key, MeshSolids& meshes);

/// `packages`, and `urdf` or `urdf_text`: the tree.
void read_urdf_of(MapReader& robot, RobotBuild& build);

/// `base`: kind, mount, speeds, wheels. The footprint's shape is left to read_collision().
void read_base(MapReader& robot, RobotBuild& build);

/// Links of the model from build.tree, and `arm`: tip, tool, locked, limits, ready. Needs read_base().
void read_arm(MapReader& robot, RobotBuild& build);

/// `base.footprint` and `collision`: shapes and self-collision pairs. Needs read_arm().
void read_collision(MapReader& robot, RobotBuild& build);

/// `sensors`: where each is mounted. Needs read_arm().
void read_sensors(MapReader& robot, RobotBuild& build);

/// `position` and `rpy` (fixed axes x, y, z as in URDF) of a map; also `rotation`, nine numbers row by row, which
/// resolved robots use.
Isometry read_pose(MapReader& in);
/// The same from the map under a key, if that is there; `written` gets what reads back to the same bits.
void read_pose(MapReader& outer, const char* name, Isometry& X, Json& written);

/// All pairs of shapes that a controlled joint can move against each other, those of adjacent links left out; in order.
std::vector<SelfPair> movable_pairs(const RobotModel& model);

/// Returns the pairs of shapes whose contact counts, by the rules of `self: auto` (robots.md): movable_pairs() without
/// those that touch at `ready`, telescope, or are within `stop` in a fifth or more of 1,000 sampled configurations.
/// Pairs that no sample brings within 0.1 m get no row. Same model, same pairs. Adds a note for what is left out, and a
/// warning if links far from each other in the chain touch at `ready`.
std::vector<SelfPair> find_self_pairs(const RobotModel& model, double stop, std::vector<std::string>& notes,
                                      std::vector<std::string>& warnings);

/// Calls visit(k, distance [m]) for each pair k of the model's self-collision pairs that is within `range` in the
/// configuration of `kinematics`; `proximity` is of the same model.
template <typename Visit>
void visit_near_pairs(Proximity& proximity, const Kinematics& kinematics, double range, Visit&& visit) {
  const std::vector<SelfPair>& pairs = kinematics.model().self_pairs;
  std::size_t k = 0;  // the answer keeps the order of the pairs
  for (const ProximityPair& pair : proximity.query(kinematics, {}, {-1.0, -1.0, range})) {
    while (pairs[k].first != pair.first || pairs[k].second != pair.second) ++k;
    visit(k, pair.distance.d);
  }
}

/// True where a controlled joint lies between the two links.
bool can_move_against(const RobotModel& model, int link1, int link2);

}  // namespace moma::config
