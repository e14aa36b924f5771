#pragma once

#include <stdexcept>

namespace moma::ode {

/// An internal error of ODE. Its world must be abandoned, not destroyed; other worlds are not affected.
class Fault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Call before any use of ODE in a thread; cheap when repeated. Starts the library once per process and installs
/// handlers: messages are counted instead of printed, and internal errors throw Fault instead of ending the process.
void use_on_this_thread();

/// Messages of the LCP solver on this thread since the last call.
int take_lcp_messages() noexcept;

}  // namespace moma::ode
