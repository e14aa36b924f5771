#pragma once

#include <ode/ode.h>

#include <vector>

namespace moma::ode {

/// Where bodies are and how they move, kept so that a step of their world can be taken back and made again: from the
/// same joints it then gives the same bits. What else ODE keeps from step to step is derived from these, or set anew
/// before each step; dWorldStep draws no random numbers and starts from no earlier solution.
class BodyStates {
 public:
  void add(dBodyID body);
  void save();
  /// The bodies as save() found them, and their geoms with them.
  void restore() const;

 private:
  struct State {
    dBodyID body;
    dReal position[3], quaternion[4], rotation[12], linear[3], angular[3];
  };
  std::vector<State> states_;
};

}  // namespace moma::ode
