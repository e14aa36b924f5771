#pragma once

#include <array>
#include <limits>

#include "tests/fuzz/bytes.h"

namespace moma::fuzz {

/// A number: ordinary ones most of the time, else one of those at which arithmetic ends.
inline double value(Bytes& bytes) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  static constexpr std::array<double, 30> kValues = {0.0,
                                                     -0.0,
                                                     1.0,
                                                     -1.0,
                                                     0.5,
                                                     -0.3,
                                                     0.02,
                                                     1e-7,
                                                     1e-12,
                                                     -1e-12,
                                                     1e-155,
                                                     1e-300,
                                                     5e-324,
                                                     1e3,
                                                     -1e3,
                                                     1e6,
                                                     -1e6,
                                                     1e9,
                                                     1e12,
                                                     -1e12,
                                                     1e20,
                                                     1e155,
                                                     -1e155,
                                                     1e308,
                                                     -1e308,
                                                     kInf,
                                                     std::numeric_limits<double>::quiet_NaN(),
                                                     3.14159265358979,
                                                     -3.14159265358979,
                                                     2.5};
  const std::size_t kind = bytes.below(kValues.size() + 68);
  if (kind < kValues.size()) return kValues[kind];
  return (static_cast<double>(bytes.byte()) - 128.0) / 40.0;
}

}  // namespace moma::fuzz
