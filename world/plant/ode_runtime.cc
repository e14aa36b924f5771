#include "world/plant/ode_runtime.h"

#include <ode/ode.h>

#include <cstdarg>
#include <cstdio>
#include <string>

namespace moma::ode {
namespace {

// ODE's handlers are process-wide; the thread that a message concerns is the one that calls them.
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

bool start() {
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

}  // namespace moma::ode
