#include "world/plant/ode_library.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>

namespace moma::ode {
namespace {

// ODE's handlers are process-wide; they run in the thread that causes a message.
thread_local int lcp_messages = 0;

std::string text_of(int number, const char* format, va_list arguments) {
  char text[512];
  std::vsnprintf(text, sizeof text, format, arguments);
  return "ODE error " + std::to_string(number) + ": " + text;
}

void count_message(int number, const char*, va_list) {
  if (number == d_ERR_LCP) ++lcp_messages;
}

[[noreturn]] void throw_fault(int number, const char* format, va_list arguments) {
  throw Fault(text_of(number, format, arguments));
}

// ODE does not check allocations, and an exception through ODE leaves it inconsistent. Without memory the program
// therefore ends by std::terminate; the handler of `new` runs first.
[[noreturn]] void no_memory() {
  if (const std::new_handler handler = std::get_new_handler()) handler();
  throw std::bad_alloc();
}
void* take(std::size_t size) noexcept {
  void* const memory = std::malloc(size);
  if (memory == nullptr && size > 0) no_memory();
  return memory;
}
void* take_more(void* before, std::size_t /*size*/, std::size_t wanted) noexcept {
  void* const memory = std::realloc(before, wanted);
  if (memory == nullptr && wanted > 0) no_memory();
  return memory;
}
void give_back(void* memory, std::size_t /*size*/) noexcept { std::free(memory); }

bool start() {
  dSetAllocHandler(take);
  dSetReallocHandler(take_more);
  dSetFreeHandler(give_back);
  if (dInitODE2(0) == 0) throw std::runtime_error("ODE cannot be initialised");
  dSetMessageHandler(count_message);
  dSetErrorHandler(throw_fault);
  dSetDebugHandler(throw_fault);
  return true;
}

}  // namespace

void use_on_this_thread() {
  static const bool started = start();
  thread_local const bool ready = started && dAllocateODEDataForThread(dAllocateMaskAll) != 0;
  if (!ready) throw std::runtime_error("ODE cannot allocate its data for this thread");
}

int take_lcp_messages() noexcept {
  const int count = lcp_messages;
  lcp_messages = 0;
  return count;
}

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

bool BodyStates::healthy(double limit) const {
  return std::ranges::all_of(states_, [limit](const State& s) {
    const Vector3 v = from_vector(dBodyGetLinearVel(s.body));
    return v.allFinite() && v.norm() <= limit && from_vector(dBodyGetAngularVel(s.body)).allFinite() &&
           from_vector(dBodyGetPosition(s.body)).allFinite();
  });
}

}  // namespace moma::ode
