#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "world/scenario/objects.h"
#include "world/scenario/scene_builder.h"

namespace moma {

/// A frame F on the floor below or beside the goal, turned about z: x points into the furniture, away from the robot.
struct FurnitureFrame {
  Vector3 origin = Vector3::Zero();  ///< in W
  double yaw = 0.0;                  ///< angle of F's x axis in W [rad]

  Vector3 point(double x, double y, double z) const;
  Vector3 into() const { return {std::cos(yaw), std::sin(yaw), 0.0}; }   ///< F's x axis in W
  Vector3 left() const { return {-std::sin(yaw), std::cos(yaw), 0.0}; }  ///< F's y axis in W
};

/// Returns an upright box; centre and edges in F.
WorldObject furniture_box(const FurnitureFrame& frame, const std::string& name, const Vector3& center_F,
                          const Vector3& edges);

/// Adds two equal boxes, NAME_left at `center_F` and NAME_right at its mirror image across the frame's x axis.
void add_left_and_right(std::vector<WorldObject>& boxes, const FurnitureFrame& frame, const std::string& name,
                        const Vector3& center_F, const Vector3& edges);

/// Position of a wall with a passage across the way of the base from start to witness.
struct WallAcross {
  using Uniform = Distribution::Uniform;
  Distribution along{Uniform{0.35, 0.65}};  ///< [1]
  Distribution offset{Uniform{-0.4, 0.4}};  ///< to the left of the way [m]
  Distribution turn{Uniform{-0.3, 0.3}};    ///< [rad]
};

constexpr void describe(auto& v, Of<WallAcross>) {
  using T = WallAcross;
  v.member("along", &T::along,
           in_range({0.0, 1.0}, "1", "position of the wall, as a share of the way from start to goal"));
  v.member("offset", &T::offset, quantity("m", "distance of the passage's middle from the way"));
  v.member("turn", &T::turn, quantity("rad", "angle between the wall and a right angle to the way"));
}

/// Draws the frame in the middle of the passage, with x through it. If base or tool of the witness is not behind the
/// wall, there is nothing to pass: returns nothing and rejects the try for `family`.
std::optional<FurnitureFrame> frame_of_passage(SceneBuilder& builder, const World& world, const WallAcross& wall,
                                               Draws& draws, const std::string& family);

/// A shelf of boards between two sides, its front in the plane x = 0 of its frame.
struct ShelfForm {
  double width = 0.0;      ///< between its sides [m]
  double depth = 0.0;      ///< [m]
  double opening = 0.0;    ///< between two boards [m]
  double thickness = 0.0;  ///< thickness of all parts [m]
  double board = 0.0;      ///< height of the middle of one board; the others follow above and below [m]
  double total = 0.0;      ///< total height [m]
  bool back = true;        ///< closed at the back
};

/// Returns the shelf's boxes, boards first, because they decide most tries. Boards are called `board` and their number.
std::vector<WorldObject> shelf_boxes(const FurnitureFrame& frame, const ShelfForm& form, const std::string& board);

/// Adds the boxes that extend above the floor to the world if all of them are clear of start and witness; otherwise
/// rejects the try as `what`.
bool add_furniture(SceneBuilder& builder, std::vector<WorldObject> boxes, const std::string& what, World& world);

/// A tabletop, from x = 0 of its frame on and to both sides of x.
struct TopForm {
  double depth = 0.0;      ///< along x [m]
  double width = 0.0;      ///< [m]
  double height = 0.0;     ///< of its upper face [m]
  double thickness = 0.0;  ///< [m]
};

/// A table: its top and four legs.
std::vector<WorldObject> table_boxes(const FurnitureFrame& frame, const TopForm& form);

/// Puts `count` objects on the top, each clear of start and witness; otherwise rejects the try as `what`.
bool add_things_on(SceneBuilder& builder, World& world, const FurnitureFrame& frame, const TopForm& form,
                   const ObjectMix& mix, int count, const std::string& what);

/// Returns half the width of the base's shapes across its driving direction [m], without the arm's shapes.
double base_half_width(const SceneBuilder& builder);

/// Returns the heading from the witness's base to the goal.
double heading_to_goal(const World& world);

}  // namespace moma
