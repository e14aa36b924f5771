#pragma once

#include "controller/model/robot_model.h"

namespace moma {

/// A ball with the density of water, held at the end effector.
struct Payload {
  double mass = 0.0;                 ///< [kg]; 0: no payload
  Vector3 p_EP_E = Vector3::Zero();  ///< centre in the end effector's frame [m]
};

/// Differences between a trial's physics and those of the robot file and docs/explanation/physics.md. Dynamic mode
/// only.
struct PlantConditions {
  Payload payload;
  double floor_friction = 1.0;  ///< between floor and driven wheels [1]
  VectorX joint_friction;       ///< dry friction of each controlled joint [Nm or N]; empty: none
};

}  // namespace moma
