#pragma once

#include <vector>

#include "controller/model/kinematics.h"
#include "world/plant/plant.h"

namespace moma {

/// Links that move together, as one rigid body: a controlled joint's link, or "@base", with everything fixed to it.
struct RigidBody {
  int link = 0;                     ///< its main link; axes of the body's frame are the link's
  int parent = -1;                  ///< index of the body before its joint; -1: the world
  int joint = -1;                   ///< controlled joint that moves it; -1 for the base
  double mass = 0.0;                ///< [kg]
  Vector3 com_L = Vector3::Zero();  ///< centre of mass in the main link's frame
  Matrix3 I_C = Matrix3::Zero();    ///< about the centre of mass, main link's axes
};

struct RigidBodies {
  std::vector<RigidBody> bodies;  ///< the base first if it is mobile, then in joint order
  std::vector<int> of_link;       ///< body of every link; -1: fixed to the world
  std::vector<Isometry, Eigen::aligned_allocator<Isometry>> X_ML;  ///< pose of every link in its body's main link
};

/// Merges links and their inertias. A mobile base's own mass is spread evenly over the volume of the shapes of "@base";
/// `payload` is merged with the end effector's link. Throws std::runtime_error with link and key for missing mass,
/// inertia or effort.
RigidBodies rigid_bodies(const RobotModel& model, double base_mass, const Payload& payload = {});

}  // namespace moma
