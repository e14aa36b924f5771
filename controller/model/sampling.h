#pragma once

#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>

#include "controller/model/robot_model.h"

namespace moma {

/// Range from which a joint's values are drawn [rad or m].
struct JointRange {
  double lower = 0.0;
  double upper = 0.0;
};

/// Returns the joint's limits; one turn about zero without limits.
inline JointRange drawn_range(const ControlledJoint& joint) noexcept {
  if (std::isfinite(joint.lower) && std::isfinite(joint.upper)) return {joint.lower, joint.upper};
  return {-std::numbers::pi, std::numbers::pi};
}

/// The `index`-th number, from 1, of the Halton sequence of a prime `base`, in (0, 1): sequences of several bases fill
/// a box evenly.
inline double halton(int index, int base) noexcept {
  double result = 0.0;
  double share = 1.0;
  for (int i = index; i > 0; i /= base) {
    share /= base;
    result += share * (i % base);
  }
  return result;
}

/// Coordinate `i` of the `index`-th of a sequence of points in a box of any dimension: Halton's, to the bases of the
/// first primes. Further coordinates reuse these bases, shifted.
inline double halton_coordinate(int index, int i) noexcept {
  constexpr int kPrimes[] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
  return halton(index + i, kPrimes[static_cast<std::size_t>(i) % std::size(kPrimes)]);
}

}  // namespace moma
