#pragma once

#include <array>
#include <span>

#include "controller/model/proximity.h"

namespace moma {

/// Largest number of ends of a pair: two of the robot's capsule, two of the object's.
inline constexpr int kMaxEnds = 4;

/// The cap sphere of a capsule against the other shape of its pair. `first` of `distance` is the robot, as in a pair.
struct EndDistance {
  int end = 0;  ///< 1, 2: of the robot's capsule at -z, +z; 3, 4: of the object's
  Distance distance;
};

/// Computes distances of the ends of an object pair's capsules, each to the other shape.
///
/// The nearest point of two nearly parallel shapes jumps from end to end from step to step. A row at that point alone
/// lets the other end swing in, and the joints oscillate. A row at each end as well holds both. The row's velocity is
/// that of the capsule's point at the cap; its rows follow qp/collision.h like any other. Other shapes have no ends.
/// `proximity` has just been queried. Returns the number of distances written.
int end_distances(Proximity& proximity, const Kinematics& kinematics, const ProximityPair& pair,
                  const ObjectState& object, std::span<EndDistance, kMaxEnds> out) noexcept;

}  // namespace moma
