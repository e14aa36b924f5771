#pragma once

#include <string>

namespace moma::store {

/// This program on this machine, as table `invocation` keeps it.
struct Machine {
  std::string host;
  std::string os;   ///< kernel and C library
  std::string cpu;  ///< model name
  int cpu_count = 0;
  std::string libraries;      ///< JSON object, name: version
  std::string machine_class;  ///< what may change the last bits: CPU features used by libm, C library, compiler,
                              ///< build, simulation libraries
};

Machine this_machine();

/// Now, UTC, ISO 8601 with milliseconds.
std::string utc_now();

}  // namespace moma::store
