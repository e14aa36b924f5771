#include "tests/support/ode_faults.h"

#include <dlfcn.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

// A world in which ODE failed is left as it is (world/plant/ode_plant.cc): of that LeakSanitizer need not tell.
// NOLINTNEXTLINE(readability-identifier-naming,bugprone-reserved-identifier): the sanitizer's name
extern "C" const char* __lsan_default_suppressions() { return "leak:moma::ode\n"; }

namespace {

struct State {
  moma::test::OdeFault fault;
  bool happened = false;
  int worlds = 0;
  dWorldID current = nullptr;
  int steps = 0;
  std::vector<dBodyID> bodies;
};

State& state() {
  static State instance;
  return instance;
}

template <typename Function>
Function* library(const char* name) {
  auto* found = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
  if (found == nullptr) throw std::runtime_error(name);
  return found;
}

}  // namespace

extern "C" {

dWorldID dWorldCreate() {
  State& s = state();
  s.current = library<dWorldID()>("dWorldCreate")();
  ++s.worlds;
  s.steps = 0;
  s.bodies.clear();
  return s.current;
}

dBodyID dBodyCreate(dWorldID world) {
  const dBodyID body = library<dBodyID(dWorldID)>("dBodyCreate")(world);
  if (world == state().current) state().bodies.push_back(body);
  return body;
}

int dWorldStep(dWorldID world, dReal h) {
  State& s = state();
  const int result = library<int(dWorldID, dReal)>("dWorldStep")(world, h);
  if (world != s.current || s.worlds - 1 != s.fault.world || s.steps++ != s.fault.step || !s.fault.act) return result;
  s.happened = true;
  return s.fault.act(world);
}

}  // extern "C"

namespace moma::test {

void arm(OdeFault fault) {
  state() = {};
  state().fault = std::move(fault);
}

bool fault_happened() { return state().happened; }

void each_body(const std::function<void(dBodyID body)>& act) {
  std::for_each(state().bodies.begin(), state().bodies.end(), act);
}

}  // namespace moma::test
