#pragma once

#include <optional>
#include <string>
#include <vector>

#include "world/scenario/object_mix.h"
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

/// Two boxes alike, NAME_left at `center_F` and NAME_right at its mirror image across the frame's x axis.
void add_left_and_right(std::vector<WorldObject>& boxes, const FurnitureFrame& frame, const std::string& name,
                        const Vector3& center_F, const Vector3& edges);

/// Where a wall stands across the way of the base from start to witness, and how.
struct WallAcross {
  double along = 0.5;   ///< part of the way [1]
  double offset = 0.0;  ///< of its passage's middle, to the left of the way [m]
  double turn = 0.0;    ///< against standing square to the way [rad]
};

/// The frame in the middle of the passage through that wall, x through it. None where base or tool of the witness are
/// not behind the wall: there would be nothing to pass, and the try is rejected for `family`.
std::optional<FurnitureFrame> frame_of_passage(SceneBuilder& builder, const World& world, const WallAcross& wall,
                                               const std::string& family);

/// A shelf of boards between two sides, its front in the plane x = 0 of its frame.
struct ShelfForm {
  double width = 0.0;      ///< between its sides [m]
  double depth = 0.0;      ///< [m]
  double opening = 0.0;    ///< between two boards [m]
  double thickness = 0.0;  ///< of all its parts [m]
  double board = 0.0;      ///< height of one board's middle; the others follow up and down [m]
  double total = 0.0;      ///< its height [m]
  bool back = true;        ///< whether it is closed at the back
};

/// The shelf's boxes, boards first: they decide most tries. Boards are called `board` and their number.
std::vector<WorldObject> shelf_boxes(const FurnitureFrame& frame, const ShelfForm& form, const std::string& board);

/// Adds the boxes that reach above the floor to the world where all of them are clear of start and witness;
/// otherwise rejects the try as `what`.
bool add_furniture(SceneBuilder& builder, std::vector<WorldObject> boxes, const std::string& what, World& world);

/// A top that things stand on, from x = 0 of its frame on and to both sides of x.
struct TopForm {
  double depth = 0.0;      ///< along x [m]
  double width = 0.0;      ///< [m]
  double height = 0.0;     ///< of its upper face [m]
  double thickness = 0.0;  ///< [m]
};

/// A table: its top and four legs.
std::vector<WorldObject> table_boxes(const FurnitureFrame& frame, const TopForm& form);

/// Puts `count` things on it, each clear of start and witness; otherwise rejects the try as `what`.
bool add_things_on(SceneBuilder& builder, World& world, const FurnitureFrame& frame, const TopForm& form,
                   const ObjectMix& mix, int count, const std::string& what);

/// Half the way across the direction in which the base drives that its shapes take [m]; the arm's are not counted.
double base_half_width(const SceneBuilder& builder);

/// Heading from the witness's base to the goal: how the robot stands to the goal.
double heading_to_goal(const World& world);

}  // namespace moma
