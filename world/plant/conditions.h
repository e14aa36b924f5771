#pragma once

#include "controller/model/robot_model.h"

namespace moma {

/// A ball of the density of water, held at the end effector.
struct Payload {
  double mass = 0.0;                 ///< [kg]; 0: nothing is held
  Vector3 p_EP_E = Vector3::Zero();  ///< its centre in the end effector's frame [m]
};

/// In what a trial's physics differ from what robot file and docs/explanation/physics.md say. Dynamic mode only.
struct PlantConditions {
  Payload payload;
  double floor_friction = 1.0;  ///< between floor and driven wheels [1]
  VectorX joint_friction;       ///< dry friction of each controlled joint [Nm or N]; empty: none
};

}  // namespace moma
