#pragma once

#include <string>

#include "world/scenario/scene_builder.h"
#include "world/world.h"

namespace moma {

/// The hand at the witness: every shape that no joint moves against the end effector. Directions are unit vectors in W.
struct Hand {
  Vector3 point = Vector3::Zero();  ///< the end effector E [m]
  Vector3 into = Vector3::UnitX();  ///< away from the arm: the axis of E nearest to the line from the wrist to E
  Vector3 thin = Vector3::UnitY();  ///< across `into`, where the hand is thinnest, to within 5 degrees
  double reach = 0.0;               ///< of the foremost point beyond E, along `into` [m]
  double above = 0.0;               ///< of the hand's surface beyond E, along `thin` [m]
  double below = 0.0;               ///< the same, against `thin` [m]
};

/// Returns the hand of a world after place_robot(). If the robot has no shape at its hand, rejects the try for `family`
/// and returns `thin` zero. Allocates.
Hand hand_at_witness(SceneBuilder& builder, const World& world, const std::string& family);

/// Puts the object before the hand, `aside` of its axis, and brings it towards the hand until it is `clearance` away.
/// If it meets the arm, or no hand, rejects the try for `family`.
bool bring_to_hand(SceneBuilder& builder, const Hand& hand, const Vector3& aside, const Eigen::Quaterniond& rotation,
                   double clearance, const std::string& family, WorldObject& object);

/// Returns a rotation whose z axis is `z` and whose x axis is as near as possible to `x`, which is not along z.
Eigen::Quaterniond rotation_along(const Vector3& z, const Vector3& x);

}  // namespace moma
