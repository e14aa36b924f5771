#pragma once

#include <ode/ode.h>

#include <functional>

// Faults inside ODE's step. Linked into a test program, ode_faults.cc stands before the library's own dWorldStep and
// dWorldCreate, and passes every call on.
namespace moma::test {

struct OdeFault {
  int world = 0;  ///< of the worlds created since arm(), from 0
  int step = 0;   ///< of its physics steps, from 0
  /// Done after that step; its result is what the step returns. May throw by dDebug() or dError().
  std::function<int(dWorldID world)> act;
};

/// One fault at a time, for programs that simulate in one thread. An empty `act` disarms.
void arm(OdeFault fault);
/// Whether the fault has happened.
bool fault_happened();

/// The bodies of the world created last, in the order of their creation.
void each_body(const std::function<void(dBodyID body)>& act);

}  // namespace moma::test
