#include "world/plant/body_states.h"

#include <algorithm>

namespace moma::ode {
namespace {

template <std::size_t N>
void take_from(const dReal* from, dReal (&to)[N]) {
  std::copy_n(from, N, to);
}

// ODE's setters normalise rotations and round in doing so, so the bodies' own numbers are restored directly. ODE hands
// out views of these numbers, which are no constants.
template <std::size_t N>
void write_past(const dReal (&from)[N], const dReal* to) {
  std::copy_n(from, N, const_cast<dReal*>(to));
}

}  // namespace

void BodyStates::add(dBodyID body) {
  State state{};
  state.body = body;
  states_.push_back(state);
}

void BodyStates::save() {
  for (State& s : states_) {
    take_from(dBodyGetPosition(s.body), s.position);
    take_from(dBodyGetQuaternion(s.body), s.quaternion);
    take_from(dBodyGetRotation(s.body), s.rotation);
    take_from(dBodyGetLinearVel(s.body), s.linear);
    take_from(dBodyGetAngularVel(s.body), s.angular);
  }
}

void BodyStates::restore() const {
  for (const State& s : states_) {
    write_past(s.quaternion, dBodyGetQuaternion(s.body));
    write_past(s.rotation, dBodyGetRotation(s.body));
    dBodySetPosition(s.body, s.position[0], s.position[1], s.position[2]);  // updates the geoms, too
    dBodySetLinearVel(s.body, s.linear[0], s.linear[1], s.linear[2]);
    dBodySetAngularVel(s.body, s.angular[0], s.angular[1], s.angular[2]);
  }
}

}  // namespace moma::ode
