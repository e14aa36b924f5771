#pragma once

#include <string>
#include <vector>

#include "world/scenario/scene_builder.h"

namespace moma {

/// A frame F on the floor below or beside the goal, turned about z: x leads into the furniture, away from the robot.
struct FurnitureFrame {
  Vector3 origin = Vector3::Zero();  ///< in W
  double yaw = 0.0;                  ///< of F's x axis in W [rad]

  Vector3 point(double x, double y, double z) const;
};

/// An upright box: centre and edges in F.
WorldObject furniture_box(const FurnitureFrame& frame, const std::string& name, const Vector3& center_F,
                          const Vector3& edges);

/// Adds the boxes that reach above the floor to the world where all of them are clear of start and witness;
/// otherwise rejects the try as `what`.
bool add_furniture(SceneBuilder& builder, std::vector<WorldObject> boxes, const std::string& what, World& world);

/// Half the way across the direction in which the base drives that its shapes take [m]; the arm's are not counted.
double base_half_width(const SceneBuilder& builder);

/// Heading from the witness's base to the goal: how the robot stands to the goal.
double heading_to_goal(const World& world);

}  // namespace moma
