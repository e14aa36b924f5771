#pragma once

#include <ode/ode.h>

#include <vector>

namespace moma::ode {

/// Saves poses and velocities of bodies, so that a step of their world can be undone and repeated: from the same joints
/// it then gives the same bits. Everything else that ODE keeps between steps follows from these or is set before each
/// step; dWorldStep draws no random numbers and has no warm start.
class BodyStates {
 public:
  void add(dBodyID body);
  void save();
  /// Restores the saved states of the bodies and their geoms.
  void restore() const;

 private:
  struct State {
    dBodyID body;
    dReal position[3], quaternion[4], rotation[12], linear[3], angular[3];
  };
  std::vector<State> states_;
};

}  // namespace moma::ode
