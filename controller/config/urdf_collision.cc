#include "controller/config/urdf_collision.h"

#include <new>
#include <utility>

#include "controller/config/robot_build.h"

namespace moma::config {

std::vector<UrdfCollision> load_urdf_collision(const std::filesystem::path& robot_file) {
  const Node node = load_yaml(robot_file);
  MapReader robot(node, "");
  RobotBuild build;
  read_urdf_of(robot, build);
  std::vector<UrdfCollision> all;
  for (const UrdfLink& link : build.tree.links) {
    for (const UrdfGeometry& geometry : link.collision) {
      UrdfCollision element;
      element.link = link.name;
      element.mesh = geometry.mesh;
      element.shape = geometry.shape;
      element.X_LS = geometry.X_LS;
      if (!geometry.mesh.empty()) {
        try {
          element.surface = read_mesh(build.packages.resolve(geometry.mesh, build.urdf_directory), geometry.scale);
        } catch (const std::bad_alloc&) {
          throw;
        } catch (const std::exception& e) {
          robot.fail_at("urdf", "link " + link.name + ": " + e.what());
        }
      }
      all.push_back(std::move(element));
    }
  }
  return all;
}

}  // namespace moma::config
