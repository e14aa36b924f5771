#include "controller/config/urdf_collision.h"

#include <new>
#include <utility>

#include "controller/config/robot_build.h"
#include "controller/model/urdf_visual.h"

namespace moma::config {

std::vector<UrdfCollision> load_urdf_collision(const std::filesystem::path& robot_file, UrdfPart part) {
  const Node node = load_yaml(robot_file);
  MapReader robot(node, "");
  RobotBuild build;
  read_urdf_of(robot, build);
  std::vector<UrdfCollision> all;
  const auto add = [&](const std::string& link, const UrdfGeometry& geometry) {
    UrdfCollision element{link, geometry.mesh, geometry.shape, {}, geometry.X_LS};
    if (!geometry.mesh.empty()) {
      try {
        element.surface = read_mesh(build.packages.resolve(geometry.mesh, build.urdf_directory), geometry.scale);
      } catch (const std::bad_alloc&) {
        throw;
      } catch (const std::exception& e) {
        robot.fail_at("urdf", "link " + link + ": " + e.what());
      }
    }
    all.push_back(std::move(element));
  };
  if (part == UrdfPart::kVisual) {
    for (const UrdfVisual& visual : read_urdf_visuals(build.resolved.at("urdf_text").get<std::string>()))
      add(visual.link, visual.geometry);
  } else {
    for (const UrdfLink& link : build.tree.links)
      for (const UrdfGeometry& geometry : link.collision) add(link.name, geometry);
  }
  return all;
}

}  // namespace moma::config
