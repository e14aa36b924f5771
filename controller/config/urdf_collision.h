#pragma once

#include <string>
#include <vector>

#include "controller/config/mesh_hull.h"
#include "controller/model/urdf.h"

namespace moma::config {

/// One collision or visual element of a URDF as it is: a primitive, or a mesh with every triangle.
struct UrdfCollision : UrdfGeometry {
  std::string link;
  Mesh surface;  ///< of a mesh, in its frame, scaled
};

enum class UrdfPart { kCollision, kVisual };

/// The collision or visual geometry of the URDF under a robot file, in the order of the URDF's tree; what the robot
/// file says under `collision` plays no part. Throws ConfigError: the file, its URDF, or a mesh that cannot be read.
std::vector<UrdfCollision> load_urdf_collision(const fs::path& robot_file, UrdfPart part = UrdfPart::kCollision);

}  // namespace moma::config
